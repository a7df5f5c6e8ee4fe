#pragma once
// The scenes that the reference renderer draws, and the rays. Plain data, owned by the test; every function of this
// folder borrows it as const, so any number of threads may share one scene.
//
// Spaces. voxel: the centre of voxel i lies at i + 0.5. physical: voxel * spacing. Lengths along a ray are counted in
// reference voxels: physical length / min(spacing).
//
// Picture. With u(s) the density, c and alpha the colour and opacity from the transfer function or a colour group,
//     sigma = -ln(1 - alpha)                     extinction per reference voxel
//     T(s)  = exp(-integral_0^s sigma)           transparency
//     C     = integral c sigma T ds,  A = 1 - T(end),  pixel = C + (1 - A) background
// and the ray ends at the first s where alpha is 1: an opaque surface of the colour found there.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr::reference {

/// Opacity and colour are linear between neighbouring points and 0 outside the outermost ones. Points at one x make a
/// step whose last point holds at x itself. Fewer than two points draw nothing. Need not be sorted.
struct ControlPoint {
    double x = 0.0;         ///< in the unit of `Scene::density`
    glm::dvec3 color{1.0};  ///< linear light
    double opacity = 0.0;   ///< per reference voxel, 0 ... 1
};

/// The material of voxels that carry this group's label, whatever their density.
struct Group {
    glm::dvec3 color{1.0};  ///< linear light
    double opacity = 1.0;   ///< per reference voxel, 0 ... 1
    bool visible = true;    ///< voxels of a hidden group are empty
};

/// With f the density, g = (f(p + e/2) - f(p - e/2)) / spacing * reference_length for each axis, m = |g|, n = -g/m:
///     w      = m^2 / (m^2 + fade^2)              how much of a surface there is
///     color' = min(1, color (ambient + diffuse ((1-w) + w max(n.L, 0))) + w specular max(n.H, 0)^shininess)
/// L points to the light, V to the eye, H = normalize(V + L). No highlight where n.L <= 0 or |V + L| < 1e-6.
struct Shading {
    double ambient = 0.3;
    double diffuse = 0.7;
    double specular = 0.2;
    double shininess = 32.0;
    double fade = 0.03;                  ///< density per reference voxel; 0: w = 1 wherever m > 1e-6
    glm::dvec3 to_light{0.0, 0.0, 1.0};  ///< physical space, need not be unit
    bool has_analytic_gradient = false;  ///< shades by slope_at() instead of central differences
    /// What `ambient` is multiplied by, trilinear between voxel centres; empty: 1. One per voxel.
    std::vector<double> ambient_shares{};
};

/// color' = mix(color', this color, clamp(size d^rate, 0, 1)) after shading, 0^0 = 1; d = clamp(depth along `forward`,
/// from `begin` to `end`, 0, 1).
struct DistanceBlend {
    glm::dvec3 color{1.0};
    double size = 0.0;
    double rate = 1.0;
    glm::dvec3 forward{0.0};  ///< unit, physical space
    double begin = 0.0, end = 1.0;
};

struct Scene {
    glm::ivec3 size{0};             ///< voxels
    std::vector<double> density{};  ///< x fastest; clamped to the edge voxels outside
    glm::dvec3 spacing{1.0};        ///< physical units per voxel
    std::vector<ControlPoint> points{};
    std::vector<uint8_t> labels{};  ///< empty, or one per voxel; 0 = transfer function, else index of a group
    std::array<Group, 256> groups{};
    std::optional<Shading> shading{};
    std::optional<DistanceBlend> blend{};  ///< in integrate_discrete only
    glm::dvec3 cut_min{0.0};               ///< voxel space; nothing outside the cut box or the volume is drawn
    glm::dvec3 cut_max{std::numeric_limits<double>::infinity()};
    glm::dvec4 cut_plane{0.0};   ///< nothing is drawn where dot(xyz, voxel) + w > 0
    glm::dvec3 background{0.0};  ///< linear light
};

/// The points origin + t * direction, t_min <= t <= t_max, in voxel space. The eye is at the side of t_min.
struct Ray {
    glm::dvec3 origin{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};  ///< need not be unit; zero: nothing is visible
    double t_min = 0.0;
    double t_max = std::numeric_limits<double>::infinity();
};

}  // namespace shvr::reference
