#pragma once
// Settings of a picture, except camera, transfer function and groups. Plain values and pure functions; any thread.

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/spelling.h"
#include "engine/volume/grid.h"

namespace shvr {

/// Maximum of OcclusionSettings::radius: occlusion gathers only nearby bricks (engine/passes/occlusion.h).
inline constexpr double MAX_OCCLUSION_RADIUS = 60.0;

/// A point of the curve from arriving to visible light. The curve is linear between points and constant outside.
struct OcclusionPoint {
    double arrives = 0.0, seen = 0.0;  ///< shares
    bool operator==(const OcclusionPoint&) const = default;
};
inline constexpr size_t MAX_OCCLUSION_POINTS = 16;

/// Ambient occlusion: how much of the ambient light reaches a point (shaders/occlusion/occlusion.h).
struct OcclusionSettings {
    double strength = 0.0;                  ///< 0: off; 1: fully enclosed places get no ambient light
    double radius = 16.0;                   ///< distance from which light arrives, in reference lengths
    uint32_t rays = 32;                     ///< per voxel
    bool full_sphere = false;               ///< also traces rays from behind surfaces
    double curve = 1.0;                     ///< exponent applied to the arriving light; above 1 is darker
    bool automatic = true;                  ///< false: the window updates occlusion only on request
    std::vector<OcclusionPoint> mapping{};  ///< replaces `curve`; sorted by `arrives`; empty: no mapping
    bool operator==(const OcclusionSettings&) const = default;
};

/// Maps `arrives`, the share of ambient light that reaches a point, to the share that is shown at strength 1.
double seen_of(const OcclusionSettings& settings, double arrives);

struct Light {
    bool shaded = true;
    double ambient = 0.3;
    double diffuse = 0.7;
    double specular = 0.2;
    double shininess = 32.0;
    glm::dvec3 direction{
        0.0};  ///< direction to the light in camera axes (right, up, back); 0,0,0: (0.3, 0.5, 1), over the shoulder
    double gradient_fade =
        0.03;  ///< gradients well below this share of `intensity_range` per voxel count as "no surface"
    OcclusionSettings occlusion;
    bool operator==(const Light&) const = default;
};

/// Distance colour blending (Rheingans and Ebert 2001): mixes in a colour with growing distance. At depth d, its share
/// is clamp(size d^rate, 0, 1), with 0^0 = 1. d is 0 where the drawn box of the volume begins along the view, and 1
/// where it ends. Size 0 turns blending off. Transparency does not change.
struct DistanceBlend {
    double size = 0.0;
    double rate = 1.0;
    std::optional<glm::dvec3> color;  ///< linear light; default: the background's
    bool operator==(const DistanceBlend&) const = default;
};

enum class Sampling { automatic, exact, hardware };
inline constexpr Spelling<Sampling> SAMPLINGS[] = {
    {Sampling::automatic, "automatic"}, {Sampling::exact, "exact"}, {Sampling::hardware, "hardware"}};
constexpr std::span<const Spelling<Sampling>> spellings_of(Sampling)
{
    return SAMPLINGS;
}

/// Whether bricks are paged on the device. Automatic: if the volume has several levels, or exceeds the memory budget.
enum class Paging { automatic, always, never };
inline constexpr Spelling<Paging> PAGINGS[] = {
    {Paging::automatic, "automatic"}, {Paging::always, "always"}, {Paging::never, "never"}};
constexpr std::span<const Spelling<Paging>> spellings_of(Paging)
{
    return PAGINGS;
}

/// How the density's gradient, which gives the normal of shading, is computed. `central`: differences over one voxel,
/// of twelve more codes than the sample's own eight. `analytic`: the derivative of the trilinear interpolation of these
/// eight, which is not continuous across voxels.
enum class Gradient { central, analytic };
inline constexpr Spelling<Gradient> GRADIENTS[] = {{Gradient::central, "central"}, {Gradient::analytic, "analytic"}};
constexpr std::span<const Spelling<Gradient>> spellings_of(Gradient)
{
    return GRADIENTS;
}

/// How unpainted voxels look, in addition to the transfer function.
struct Unpainted {
    bool visible = true;
    double opacity = 1.0;  ///< factor on the transfer function's opacities
    bool operator==(const Unpainted&) const = default;
};

struct RenderSettings {
    glm::uvec2 size{512, 512};                  ///< pixels
    double step_voxels = 0.5;                   ///< in reference lengths (voxels along the finest axis)
    double opacity_limit = 1.0 - 1.0 / 1024;    ///< a ray ends once its opacity reaches this value
    glm::dvec4 background{1.0, 1.0, 1.0, 1.0};  ///< linear light, straight alpha
    Sampling sampling = Sampling::automatic;
    Paging paging = Paging::automatic;
    double detail = 1.0;  ///< minimum voxels per pixel in volumes with several levels; 0: always the finest level
    bool skip_empty_space = true;
    bool preintegration = false;  ///< looks up steps by both end values (preintegration.h); for steps of at most 1
    /// Integrates light exactly, between voxel borders and points of the transfer function, instead of sampling it in
    /// steps (shaders/rays/integral.comp). Requires steps of at most 1 and exact sampling. Overrides preintegration.
    bool exact_integral = false;
    Gradient gradient = Gradient::central;  ///< of samples in steps; the exact integral and occlusion use `central`
    /// Smooths the borders of painted groups: a sample takes the label with the largest total weight among its eight
    /// neighbouring voxels instead of the nearest voxel's label. Slices and occlusion still use the nearest voxel.
    bool smooth_borders = false;
    double saturation = 1.0;  ///< saturation of everything except lines over the picture; 0: greys of equal luminance
    bool classifies_steps() const { return preintegration && !exact_integral; }
    bool operator==(const RenderSettings&) const = default;
};

/// The part of the volume that cutting planes leave: six along the axes, and an oblique one, of any orientation.
struct CutBox {
    glm::dvec3 lower{0.0};  ///< voxels
    glm::dvec3 upper{double(MAX_SIDE)};
    std::optional<glm::dvec3> plane_normal{};  ///< direction in physical space towards what is removed; null: no plane
    std::optional<glm::dvec3> plane_point{};   ///< voxel on the plane; default: the volume's centre
    bool operator==(const CutBox&) const = default;
};

/// Returns the plane as dot(xyz, voxel) + w, which is the distance beyond the plane in physical units; 0 everywhere if
/// there is no plane.
inline glm::dvec4 plane_in_voxels(const CutBox& cut, const Size3& size, const glm::dvec3& spacing)
{
    if (!cut.plane_normal) return glm::dvec4(0.0);
    const glm::dvec3 along = glm::normalize(*cut.plane_normal) * spacing;
    return {along, -glm::dot(along, cut.plane_point.value_or(0.5 * glm::dvec3(size)))};
}

}  // namespace shvr
