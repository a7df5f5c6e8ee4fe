#include "engine/annotation/trace/local_radius.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shvr {

namespace {

constexpr size_t DIRECTIONS = 200;  ///< about 9 degrees apart
/// Smallest relative growth of the radius that counts; a growth below 0.1 % is noise of the finite set of directions.
constexpr double NOTICEABLE = 1.001;

/// Directions spread evenly over the sphere (a Fibonacci lattice).
const std::array<glm::dvec3, DIRECTIONS>& directions()
{
    static const std::array<glm::dvec3, DIRECTIONS> ALL = [] {
        std::array<glm::dvec3, DIRECTIONS> all;
        const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
        for (size_t i = 0; i < DIRECTIONS; ++i) {
            const double z = 1.0 - (2.0 * double(i) + 1.0) / double(DIRECTIONS), ring = std::sqrt(1.0 - z * z);
            all[i] = {ring * std::cos(golden * double(i)), ring * std::sin(golden * double(i)), z};
        }
        return all;
    }();
    return ALL;
}

class Structure {
public:
    Structure(const DensityAt& density_at, double threshold, const glm::dvec3& spacing, double most)
        : density_at_(density_at),
          threshold_(threshold),
          spacing_(spacing),
          most_(most),
          step_(0.5 * std::min({spacing.x, spacing.y, spacing.z}))
    {}

    /// Distance from a point to the nearest point outside the structure, at most `most`; 0 if the point is outside.
    double depth_of(const glm::dvec3& point) const
    {
        if (density(point) < threshold_) return 0.0;
        double nearest = most_;
        for (const glm::dvec3& direction : directions())
            nearest = std::min(nearest, way_out(point, direction, nearest));
        return nearest;
    }
    double finest() const { return 2.0 * step_; }
    double step() const { return step_; }
    bool contains(const glm::dvec3& point) const { return density(point) >= threshold_; }

private:
    double density(const glm::dvec3& point) const { return density_at_(point / spacing_); }
    double way_out(const glm::dvec3& point, const glm::dvec3& direction, double most) const
    {
        double before = density(point);
        for (double way = step_; way < most + step_; way += step_) {
            const double here = density(point + way * direction);
            if (here < threshold_) return way - step_ * (threshold_ - here) / std::max(before - here, 1e-300);
            before = here;
        }
        return most;
    }

    const DensityAt& density_at_;
    double threshold_;
    glm::dvec3 spacing_;
    double most_, step_;
};

/// Climbs in decreasing steps from `point` to a local maximum of the ball's radius. The ball must contain `point`, and
/// `may_be` must allow its centre. Returns the centre in the unit of the spacing.
template <class MayBe>
std::optional<LocalBall> largest_ball(const Structure& structure, const glm::dvec3& point, double most,
                                      const MayBe& may_be)
{
    glm::dvec3 center = point;
    double radius = structure.depth_of(center);
    if (radius <= 0.0) return std::nullopt;
    const double finest = structure.finest();
    bool is_held = false;
    for (double step = std::max(0.5 * radius, finest); step > 0.05 * finest && radius < most;) {
        glm::dvec3 better = center;
        double larger = radius;
        bool is_refused = false;
        for (int i = 0; i < 27; ++i) {
            const glm::dvec3 way(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            if (i == 13) continue;
            const glm::dvec3 tried = center + step * glm::normalize(way);
            if (glm::distance(tried, point) > larger + step) continue;
            const double depth = structure.depth_of(tried);
            if (depth <= larger || glm::distance(tried, point) >= depth) continue;
            if (!may_be(tried)) {
                is_refused |= depth > NOTICEABLE * radius;
                continue;
            }
            better = tried;
            larger = depth;
        }
        if (larger > NOTICEABLE * radius) {
            center = better;
            radius = larger;
            is_held = false;
        } else {
            step *= 0.5;
        }
        is_held |= is_refused;
    }
    return radius < most ? std::optional(LocalBall{center, radius, is_held}) : std::nullopt;
}

std::optional<LocalBall> in_voxels(std::optional<LocalBall> ball, const glm::dvec3& spacing)
{
    if (ball) ball->middle /= spacing;
    return ball;
}

}  // namespace

std::optional<LocalBall> local_ball(const DensityAt& density_at, double threshold, const glm::dvec3& voxel,
                                    const glm::dvec3& spacing, double most)
{
    const Structure structure(density_at, threshold, spacing, most);
    return in_voxels(largest_ball(structure, voxel * spacing, most, [](const glm::dvec3&) { return true; }), spacing);
}

std::optional<LocalBall> ball_behind(const DensityAt& density_at, double threshold, const glm::dvec3& voxel,
                                     const glm::dvec3& way, const glm::dvec3& spacing, double most, double aside)
{
    const Structure structure(density_at, threshold, spacing, most);
    const glm::dvec3 from = voxel * spacing, direction = glm::normalize(way);
    const auto is_near_sight = [&](const glm::dvec3& point) {
        return glm::length(point - from - glm::dot(point - from, direction) * direction) <= aside;
    };
    // The search starts in front of the visible point, which lies where a wall's density rises most steeply: the wall's
    // middle may be a voxel nearer to the eye. Grains on the line that are thinner than a voxel are skipped as noise.
    double begin = -2.0 * structure.finest();
    while (begin <= most) {
        while (begin <= most && !structure.contains(from + begin * direction)) begin += structure.step();
        double end = begin;
        while (end - begin <= 2.0 * most && structure.contains(from + end * direction)) end += structure.step();
        if (end - begin > 2.0 * most) return std::nullopt;
        const double middle = 0.5 * (begin + end - structure.step());
        if (begin <= most && end - begin > structure.finest())
            return in_voxels(largest_ball(structure, from + middle * direction, most, is_near_sight), spacing);
        begin = end + structure.step();
    }
    return std::nullopt;
}

double DensityBox::at(const glm::dvec3& voxel) const
{
    const glm::dvec3 lattice = glm::clamp(voxel - 0.5 - glm::dvec3(lower), glm::dvec3(0.0), glm::dvec3(size - 1));
    const glm::ivec3 corner = glm::min(glm::ivec3(glm::floor(lattice)), glm::max(size - 2, glm::ivec3(0)));
    const glm::dvec3 share = lattice - glm::dvec3(corner);
    double sum = 0.0;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 offset(i & 1, i >> 1 & 1, i >> 2 & 1);
        const glm::dvec3 weights = glm::mix(1.0 - share, share, glm::dvec3(offset));
        const double weight = weights.x * weights.y * weights.z;
        if (weight == 0.0) continue;
        const glm::ivec3 at = glm::min(corner + offset, size - 1);
        sum += weight * values[size_t(at.x) + size_t(size.x) * (size_t(at.y) + size_t(size.y) * size_t(at.z))];
    }
    return sum;
}

}  // namespace shvr
