#include "tests/reference/field.h"

#include <algorithm>
#include <cmath>

namespace shvr::reference {

namespace {

size_t index_of(const Scene& scene, const glm::ivec3& voxel)
{
    return (size_t(voxel.z) * size_t(scene.size.y) + size_t(voxel.y)) * size_t(scene.size.x) + size_t(voxel.x);
}

// Two-sided, so that both ends are exact: a + (b - a) need not be b.
double between(double a, double b, double share)
{
    return share < 0.5 ? a + (b - a) * share : b - (b - a) * (1.0 - share);
}

}  // namespace

Cell cell_at(const Scene& scene, const glm::dvec3& voxel)
{
    const glm::dvec3 last = glm::dvec3(scene.size) - 1.0;
    const glm::ivec3 low(glm::floor(glm::clamp(voxel - 0.5, glm::dvec3(0.0), last)));
    Cell cell{.low_centre = glm::dvec3(low) + 0.5};
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 neighbour = low + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
        cell.corners[size_t(corner)] = scene.density[index_of(scene, glm::min(neighbour, scene.size - 1))];
    }
    return cell;
}

double value_in(const Cell& cell, const glm::dvec3& voxel)
{
    const glm::dvec3 share = glm::clamp(voxel - cell.low_centre, 0.0, 1.0);
    const std::array<double, 8>& c = cell.corners;
    const double low_y = between(between(c[0], c[1], share.x), between(c[2], c[3], share.x), share.y);
    const double high_y = between(between(c[4], c[5], share.x), between(c[6], c[7], share.x), share.y);
    return between(low_y, high_y, share.z);
}

double density_at(const Scene& scene, const glm::dvec3& voxel)
{
    return value_in(cell_at(scene, voxel), voxel);
}

glm::dvec3 difference_at(const Scene& scene, const glm::dvec3& voxel)
{
    glm::dvec3 difference(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 half(0.0);
        half[axis] = 0.5;
        difference[axis] = density_at(scene, voxel + half) - density_at(scene, voxel - half);
    }
    return difference;
}

glm::dvec3 slope_at(const Scene& scene, const glm::dvec3& voxel)
{
    const Cell cell = cell_at(scene, voxel);
    glm::dvec3 slope(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        if (voxel[axis] < cell.low_centre[axis]) continue;  // outside the centres, where values are those of the edge
        glm::dvec3 low = voxel, high = voxel;
        low[axis] = cell.low_centre[axis];
        high[axis] = cell.low_centre[axis] + 1.0;
        slope[axis] = value_in(cell, high) - value_in(cell, low);
    }
    return slope;
}

glm::dvec3 gradient_at(const Scene& scene, const glm::dvec3& voxel)
{
    const bool is_analytic = scene.shading && scene.shading->has_analytic_gradient;
    return (is_analytic ? slope_at(scene, voxel) : difference_at(scene, voxel)) / scene.spacing *
           reference_length(scene);
}

uint8_t label_at(const Scene& scene, const glm::dvec3& voxel)
{
    if (scene.labels.empty()) return 0;
    const glm::dvec3 inside = glm::clamp(glm::floor(voxel), glm::dvec3(0.0), glm::dvec3(scene.size) - 1.0);
    return scene.labels[index_of(scene, glm::ivec3(inside))];
}

double reference_length(const Scene& scene)
{
    return std::min({scene.spacing.x, scene.spacing.y, scene.spacing.z});
}

}  // namespace shvr::reference
