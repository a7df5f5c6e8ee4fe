#include "tests/reference/occlusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shvr::reference {

namespace {

glm::dvec3 turned(const glm::dvec3& direction, const OcclusionSide& side)
{
    return glm::dot(direction, side.normal) < side.surface - 1.0 ? -direction : direction;
}

/// The opacity, rounded to 8 bits.
double kept(double opacity)
{
    const double code = std::floor(255.0 * std::sqrt(opacity) + 0.5);
    return code * code / (255.0 * 255.0);
}

double opacity_of(double one, double stretch)
{
    return 1.0 - std::pow(1.0 - one, stretch);
}

/// Opacity over the stretch of a tap in the cell that holds a voxel.
double cell_opacity(const VoxelOpacity& opacity, const glm::ivec3& voxel, int side, double exponent)
{
    const glm::ivec3 first = glm::ivec3(glm::floor(glm::dvec3(voxel) / double(side))) * side;
    double sum = 0.0;
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) sum += opacity_of(opacity(first + glm::ivec3(x, y, z)), side);
    return kept(opacity_of(kept(sum / (side * side * side)), exponent));
}

/// Opacity over the stretch of a near tap: in sevenths of the voxel's maximum.
double near_opacity(const HalfOpacity& halves, const glm::ivec3& half_voxel, double stretch)
{
    const glm::ivec3 voxel(glm::floor(glm::dvec3(half_voxel) / 2.0)), half = half_voxel - 2 * voxel;
    double greatest = 0.0;
    for (int i = 0; i < 8; ++i)
        greatest = std::max(greatest, opacity_of(halves(voxel, {i & 1, i >> 1 & 1, i >> 2}), stretch));
    if (greatest == 0.0) return 0.0;
    return kept(greatest) * std::floor(7.0 * opacity_of(halves(voxel, half), stretch) / greatest + 0.5) / 7.0;
}

}  // namespace

double occlusion_by_taps(const VoxelOpacity& opacity, const HalfOpacity& halves, const OcclusionRays& rays,
                         const glm::ivec3& voxel, const OcclusionSide& side)
{
    const glm::dvec3 lift = side.surface * side.normal * rays.voxels_per_unit;
    double sum = 0.0;
    for (const glm::dvec3& direction : rays.directions) {
        const glm::dvec3 step = turned(direction, side) * rays.voxels_per_unit;
        double left = 1.0, light = rays.first;
        for (const OcclusionTap& tap : rays.taps) {
            const glm::dvec3 place = glm::dvec3(voxel) + 0.5 + tap.distance * step + tap.lift * lift;
            const glm::ivec3 at(glm::floor(place));
            double stopped = 0.0;
            if (tap.side > 0)
                stopped = cell_opacity(opacity, at, tap.side, rays.exponent);
            else if (at != voxel)
                stopped = near_opacity(halves, glm::ivec3(glm::floor(2.0 * place)), tap.stretch);
            light += left * tap.stretch * 0.5 * (2.0 - stopped);
            left *= 1.0 - stopped;
        }
        sum += light / rays.radius;
    }
    return sum / double(rays.directions.size());
}

double occlusion_by_taps(const VoxelOpacity& opacity, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side)
{
    const HalfOpacity halves = [&](const glm::ivec3& of, const glm::ivec3&) { return opacity(of); };
    return occlusion_by_taps(opacity, halves, rays, voxel, side);
}

double occlusion_by_steps(const FieldOpacity& opacity, const std::vector<glm::dvec3>& directions, double radius,
                          int steps, double first, double lift, const glm::dvec3& position, const OcclusionSide& side)
{
    const double step = radius / steps;
    double sum = 0.0;
    for (const glm::dvec3& direction : directions) {
        const glm::dvec3 ahead = turned(direction, side);
        const glm::dvec3 origin = position + lift * side.surface * side.normal;
        double left = 1.0;
        for (int i = 0; i < steps; ++i) {
            sum += left / steps;
            const double distance = (i + 1) * step;
            if (distance >= first) left *= std::pow(1.0 - opacity(origin + distance * ahead), step);
        }
    }
    return sum / double(directions.size());
}

std::vector<glm::dvec3> occlusion_directions(uint32_t count)
{
    const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));  // the golden angle
    std::vector<glm::dvec3> directions;
    for (uint32_t k = 0; k < count; ++k) {
        const double z = 1.0 - (2.0 * k + 1.0) / count, r = std::sqrt(1.0 - z * z);
        directions.emplace_back(r * std::cos(turn * k), r * std::sin(turn * k), z);
    }
    return directions;
}

}  // namespace shvr::reference
