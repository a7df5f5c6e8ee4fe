#pragma once
// Local ambient occlusion in double, two ways: as shaders/occlusion/occlusion.h defines the device's computation, cell
// by cell, and as the sum over equal steps that it approximates. Lengths are in voxels of the finest axis.

#include <functional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr::reference {

/// Treatment of rays at a surface (0 ... 1): they start above it, and none comes from behind.
struct OcclusionSide {
    glm::dvec3 normal{0.0};
    double surface = 0.0;
};

struct OcclusionTap {
    double distance, lift, stretch;
    int side;  ///< of the cell that is sampled, in voxels; 0: half a voxel
};
struct OcclusionRays {
    double radius = 16.0, first = 0.5;
    std::vector<OcclusionTap> taps;
    std::vector<glm::dvec3> directions;
    double exponent = 1.0;  ///< from the path through a cell to the stretch of its taps
    glm::dvec3 voxels_per_unit{1.0};
};

/// Unit vectors spread evenly over the sphere (spherical Fibonacci points, Gonzalez 2010), as the kernel takes them.
std::vector<glm::dvec3> occlusion_directions(uint32_t count);

/// Opacity of one unit for any voxel; 0 outside the volume.
using VoxelOpacity = std::function<double(const glm::ivec3&)>;
/// Opacity of one unit for every half of a voxel: the voxel, and 0 or 1 along each axis.
using HalfOpacity = std::function<double(const glm::ivec3&, const glm::ivec3&)>;
double occlusion_by_taps(const VoxelOpacity& opacity, const HalfOpacity& halves, const OcclusionRays& rays,
                         const glm::ivec3& voxel, const OcclusionSide& side);
/// For volumes in which all halves of a voxel are equal.
double occlusion_by_taps(const VoxelOpacity& opacity, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side);

/// Opacity of one unit anywhere.
using FieldOpacity = std::function<double(const glm::dvec3&)>;
/// (1 / M) sum over m of the product over i < m of (1 - a_i), the mean over directions. Sample i lies at (i + 1) steps,
/// and samples nearer than `first` are not taken.
double occlusion_by_steps(const FieldOpacity& opacity, const std::vector<glm::dvec3>& directions, double radius,
                          int steps, double first, double lift, const glm::dvec3& position, const OcclusionSide& side);

}  // namespace shvr::reference
