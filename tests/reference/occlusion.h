#pragma once
// Local ambient occlusion in double, two ways: the definition of shaders/occlusion/occlusion.h, over any number of
// directions and steps, and the few samples per ray by which the device computes it. Positions are in voxels, lengths
// along rays in units.

#include <array>
#include <functional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr::reference {

/// Opacity of one unit anywhere.
using FieldOpacity = std::function<double(const glm::dvec3&)>;
/// Opacity of one unit for any voxel; 0 outside the volume.
using VoxelOpacity = std::function<double(const glm::ivec3&)>;
/// How much of a surface is at a voxel (0 ... 1), its normal, and the direction, in voxels, in which densities fall
/// fastest per voxel: the normal if voxels are cubes.
struct OcclusionSide {
    glm::dvec3 normal{0.0, 0.0, 1.0};
    double strength = 0.0;
    glm::dvec3 fall{0.0, 0.0, 1.0};
};

struct OcclusionAsked {
    double radius = 16.0;
    bool full_sphere = false;
    glm::dvec3 voxels_per_unit{1.0};
};

/// Unit vectors spread evenly over the sphere (spherical Fibonacci points, Gonzalez 2010), or about a normal: twice as
/// dense where the rays from behind the surface come from, too.
std::vector<glm::dvec3> occlusion_directions(uint32_t count);
std::vector<glm::dvec3> occlusion_directions(uint32_t count, const OcclusionSide& side, bool full_sphere);

/// Distance of a point from the end of the medium, in voxels along a direction in voxels.
double occlusion_edge(const FieldOpacity& opacity, const glm::dvec3& centre, const glm::dvec3& fall);
/// The definition: the light that arrives at a voxel.
double occlusion_defined(const FieldOpacity& opacity, const OcclusionAsked& asked, const glm::ivec3& voxel,
                         const OcclusionSide& side, uint32_t directions, int steps);
/// (1 / M) sum over m of the product over i < m of (1 - a_i), the mean over directions; sample i lies at (i + 1) steps.
double occlusion_by_steps(const FieldOpacity& opacity, const std::vector<glm::dvec3>& directions, double radius,
                          int steps, const glm::dvec3& origin);

struct OcclusionTap {
    double distance, stretch;
    int side;  ///< side of the sampled cell, in voxels
};
struct OcclusionRays {
    OcclusionAsked asked;
    uint32_t count = 32;
    double first = 0.0;  ///< units that light always passes
    std::vector<OcclusionTap> taps;
    double near_stretch = 1.0;                      ///< stretch of the first tap in voxels
    double stretch_of_2 = 1.0, stretch_of_4 = 1.0;  ///< stretches of taps in cells
};

/// How opaque a cube is from place to place, as the device keeps it (shaders/occlusion/occlusion.h).
struct OcclusionRamp {
    double top = 0.0, height = 0.0;
    glm::dvec3 slope{0.0};

    double left(const glm::dvec3& from_middle) const;
};
/// How steeply ramps may rise across their cube (shaders/occlusion/occlusion_ramp.glsl).
constexpr double STEEPEST_OF_VOXELS = 3.3, STEEPEST_OF_CELLS = 2.6;
/// Makes a ramp from the means over the cube of opacity / `top` (`level`) and of its square, and the direction in which
/// it rises, with limited slope.
OcclusionRamp occlusion_ramp(double top, double level, double squares, const glm::dvec3& direction, double steepest);
/// Makes a ramp from the opacities of the eight voxels of a cell, x fastest.
OcclusionRamp occlusion_ramp(const std::array<double, 8>& opacities);

/// The opacity at a place, if the voxel at the other one is kept: the middle between two samples.
using EdgeOpacity = std::function<double(const glm::dvec3&, const glm::dvec3&)>;

/// The quantities that the device samples in a medium.
struct OcclusionMedium {
    VoxelOpacity opacity;
    std::function<OcclusionRamp(const glm::ivec3&)> voxel;  ///< over the stretch of the first tap
    std::function<OcclusionRamp(const glm::ivec3&)> cell;   ///< of 2^3 voxels, over the stretch of a tap
    EdgeOpacity edge;                                       ///< as `voxel`, along the normal
};
double occlusion_by_taps(const OcclusionMedium& medium, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side);
/// The same for a medium that is constant inside each voxel.
double occlusion_by_taps(const VoxelOpacity& opacity, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side);

}  // namespace shvr::reference
