#include "tests/reference/occlusion.h"

#include <algorithm>
#include <cmath>

namespace shvr::reference {

namespace {

glm::dvec3 turned(const glm::dvec3& direction, const OcclusionSide& side)
{
    return glm::dot(direction, side.normal) < side.surface - 1.0 ? -direction : direction;
}

/// Of the way through the cell that holds a voxel, as its 8 bits keep it.
double kept_opacity(const VoxelOpacity& opacity, const glm::ivec3& voxel, int side)
{
    const glm::ivec3 first = glm::ivec3(glm::floor(glm::dvec3(voxel) / double(side))) * side;
    double sum = 0.0;
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                double left = 1.0;
                for (int i = 0; i < side; ++i) left *= 1.0 - opacity(first + glm::ivec3(x, y, z));
                sum += 1.0 - left;
            }
    const double code = std::floor(255.0 * std::sqrt(sum / (side * side * side)) + 0.5);
    return code * code / (255.0 * 255.0);
}

}  // namespace

double occlusion_by_taps(const VoxelOpacity& opacity, const OcclusionRays& rays, const glm::ivec3& voxel,
                         const OcclusionSide& side)
{
    const glm::dvec3 lift = side.surface * side.normal * rays.voxels_per_unit;
    double sum = 0.0;
    for (const glm::dvec3& direction : rays.directions) {
        const glm::dvec3 step = turned(direction, side) * rays.voxels_per_unit;
        double left = 1.0, light = rays.first;
        for (const OcclusionTap& tap : rays.taps) {
            const glm::ivec3 at(glm::floor(glm::dvec3(voxel) + 0.5 + tap.distance * step + tap.lift * lift));
            const bool is_own = tap.side == 1 && at == voxel;
            const double passed =
                is_own ? 1.0 : std::pow(1.0 - kept_opacity(opacity, at, tap.side), tap.stretch / tap.side);
            light += left * tap.stretch * 0.5 * (1.0 + passed);
            left *= passed;
        }
        sum += light / rays.radius;
    }
    return sum / double(rays.directions.size());
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

}  // namespace shvr::reference
