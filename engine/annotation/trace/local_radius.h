#pragma once
// How wide a structure is at a point, and where its middle is: the largest ball that lies inside it and contains the
// point, its local thickness (Hildebrand and Rüegsegger 1997). A point beside the middle line gets the ball of the
// whole structure. Pure; any thread.
//
// Errors, on straight tubes of radius 2 to 8 voxels whose edge is a voxel wide, at points up to 0.6 radii beside the
// axis: of the radius below 0.15 voxels, of the middle across the tube below 0.3
// (tests/unit/annotation/trace/local_radius_test.cpp).

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

/// At a position in voxels; interpolated linearly, as pictures are.
using DensityAt = std::function<double(const glm::dvec3& voxel)>;

struct LocalBall {
    glm::dvec3 middle{0.0};  ///< voxels
    double radius = 0.0;     ///< in the unit of `spacing`
    bool is_held = false;    ///< a larger ball lies further aside than was allowed
};
/// What is at or above `threshold` is inside. Null where the point is not, or where the structure goes on for `most`,
/// in the unit of `spacing`, in all directions.
std::optional<LocalBall> local_ball(const DensityAt& density_at, double threshold, const glm::dvec3& voxel,
                                    const glm::dvec3& spacing, double most);
/// Of what a line of sight enters at `voxel` or at most `most` behind it: the ball about the middle of its way through.
/// `way`: in volume space, any length. `aside`: how far the middle may lie from the line of sight, in the unit of
/// `spacing`. Null where it enters nothing, or does not leave it within `2 * most`.
std::optional<LocalBall> ball_behind(const DensityAt& density_at, double threshold, const glm::dvec3& voxel,
                                     const glm::dvec3& way, const glm::dvec3& spacing, double most,
                                     double aside = std::numeric_limits<double>::infinity());

/// Voxels in a box, for DensityAt: outside it the nearest of them.
struct DensityBox {
    glm::ivec3 lower{0}, size{1};  ///< voxels
    std::vector<double> values{};  ///< x fastest
    double at(const glm::dvec3& voxel) const;
};

}  // namespace shvr
