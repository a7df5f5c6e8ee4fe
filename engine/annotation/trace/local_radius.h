#pragma once
// Measures how wide a structure is at a point, and where its centre is: finds the largest ball that lies inside the
// structure and contains the point, its local thickness (Hildebrand and Rüegsegger 1997). For a point off the centre
// line this is still the ball of the whole structure. Pure; any thread.
//
// Errors on straight tubes of radius 2 to 8 voxels with an edge one voxel wide, at points up to 0.6 radii off the axis:
// below 0.15 voxels for the radius, below 0.3 voxels for the centre across the tube
// (tests/unit/annotation/trace/local_radius_test.cpp).

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace shvr {

/// Returns the density at a position in voxels, interpolated linearly as in rendering.
using DensityAt = std::function<double(const glm::dvec3& voxel)>;

struct LocalBall {
    glm::dvec3 middle{0.0};  ///< voxels
    double radius = 0.0;     ///< in the unit of `spacing`
    bool is_held = false;    ///< a larger ball was rejected because its centre is too far from the line of sight
};
/// The largest ball inside the structure; positions with a density of `threshold` or more are inside. Null if the point
/// is not inside, or if the structure extends for `most` (in the unit of `spacing`) in all directions.
std::optional<LocalBall> local_ball(const DensityAt& density_at, double threshold, const glm::dvec3& voxel,
                                    const glm::dvec3& spacing, double most);
/// Returns the ball at the middle of the part of a line of sight that lies in the structure. The line must enter the
/// structure at `voxel` or at most `most` behind it. `way`: the line's direction in volume space, of any length.
/// `aside`: greatest distance of the ball's centre from the line, in the unit of `spacing`. Null if the line enters no
/// structure, or does not leave it within `2 * most`.
std::optional<LocalBall> ball_behind(const DensityAt& density_at, double threshold, const glm::dvec3& voxel,
                                     const glm::dvec3& way, const glm::dvec3& spacing, double most,
                                     double aside = std::numeric_limits<double>::infinity());

/// Densities of the voxels of a box; outside the box, the density of the nearest voxel.
struct DensityBox {
    glm::ivec3 lower{0}, size{1};  ///< voxels
    std::vector<double> values{};  ///< x fastest
    double at(const glm::dvec3& voxel) const;
};

}  // namespace shvr
