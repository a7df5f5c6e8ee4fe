#pragma once
// Local ambient occlusion in double, two ways: the definition of shaders/occlusion/occlusion.h, over as many directions
// and steps as one likes, and the few samples a ray by which the device computes it. Positions are in voxels, lengths
// along rays in units.

#include <functional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr::reference {

/// Opacity of one unit anywhere.
using FieldOpacity = std::function<double(const glm::dvec3&)>;
/// Opacity of one unit for any voxel; 0 outside the volume.
using VoxelOpacity = std::function<double(const glm::ivec3&)>;
/// Opacity of one unit for every half of a voxel: the voxel, and 0 or 1 along each axis.
using HalfOpacity = std::function<double(const glm::ivec3&, const glm::ivec3&)>;

/// How much of a surface is at a voxel (0 ... 1), and its normal.
struct OcclusionSide {
    glm::dvec3 normal{0.0, 0.0, 1.0};
    double strength = 0.0;
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

/// How far along its normal a point is from where the medium ends.
double occlusion_edge(const FieldOpacity& opacity, const OcclusionAsked& asked, const glm::dvec3& centre,
                      const glm::dvec3& normal);
/// The definition: the light that arrives at a voxel.
double occlusion_defined(const FieldOpacity& opacity, const OcclusionAsked& asked, const glm::ivec3& voxel,
                         const OcclusionSide& side, uint32_t directions, int steps);
/// (1 / M) sum over m of the product over i < m of (1 - a_i), the mean over directions; sample i lies at (i + 1) steps.
double occlusion_by_steps(const FieldOpacity& opacity, const std::vector<glm::dvec3>& directions, double radius,
                          int steps, const glm::dvec3& origin);

struct OcclusionTap {
    double distance, stretch;
    int side;  ///< of the cell that is sampled, in voxels; 0: half a voxel
};
struct OcclusionRays {
    OcclusionAsked asked;
    uint32_t count = 32;
    double first = 0.0;  ///< units that light always passes
    std::vector<OcclusionTap> taps;
    double near_stretch = 1.0;
    double stretched = 1.0;  ///< of a tap in cells, in sides of those cells
};
double occlusion_by_taps(const VoxelOpacity& opacity, const HalfOpacity& halves, const OcclusionRays& rays,
                         const glm::ivec3& voxel, const OcclusionSide& side);
/// For volumes in which all halves of a voxel are equal.
double occlusion_by_taps(const VoxelOpacity& opacity, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side);

}  // namespace shvr::reference
