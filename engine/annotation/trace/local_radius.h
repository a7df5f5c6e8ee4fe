#pragma once
// Measures how wide a structure is at a point, and where its centre is: the largest ball that lies inside it and
// contains the point, its local thickness (Hildebrand and Rüegsegger 1997). A point off the centre line gets the ball
// of the whole structure. Pure; any thread.
//
// Errors, on straight tubes of radius 2 to 8 voxels whose edge is a voxel wide, at points up to 0.6 radii off the axis:
// below 0.15 voxels for the radius, below 0.3 for the centre across the tube
// (tests/unit/annotation/trace/local_radius_test.cpp).

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

/// Density at a position in voxels; interpolated linearly, as in pictures.
using DensityAt = std::function<double(const glm::dvec3& voxel)>;

struct LocalBall {
    glm::dvec3 middle{0.0};  ///< voxels
    double radius = 0.0;     ///< in the unit of `spacing`
    bool is_held = false;    ///< a larger ball was rejected: its centre is too far from the line of sight
};
/// The largest ball inside the structure, where positions at or above `threshold` are inside. Null if the point is not
/// inside, or if the structure extends for `most` (in the unit of `spacing`) in all directions.
std::optional<LocalBall> local_ball(const DensityAt& density_at, double threshold, const glm::dvec3& voxel,
                                    const glm::dvec3& spacing, double most);
/// Returns the ball around the middle of a line of sight's path through the structure that the line enters at `voxel`,
/// or at most `most` behind `voxel`. `way`: the line's direction in volume space, any length. `aside`: how far the
/// ball's centre may be from the line, in the unit of `spacing`. Null if the line enters no structure, or does not
/// leave it within `2 * most`.
std::optional<LocalBall> ball_behind(const DensityAt& density_at, double threshold, const glm::dvec3& voxel,
                                     const glm::dvec3& way, const glm::dvec3& spacing, double most,
                                     double aside = std::numeric_limits<double>::infinity());

/// Voxels in a box, as a DensityAt: a position outside the box takes the value of the nearest voxel.
struct DensityBox {
    glm::ivec3 lower{0}, size{1};  ///< voxels
    std::vector<double> values{};  ///< x fastest
    double at(const glm::dvec3& voxel) const;
};

}  // namespace shvr
