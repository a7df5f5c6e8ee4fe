#include "engine/annotation/meshes/surface_smoothing.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr uint32_t NONE = UINT32_MAX;
using Neighbours = std::vector<std::array<uint32_t, 6>>;  ///< 2 axis: below, 2 axis + 1: above

/// Calls `visit(view, corner, point)` for each point.
template <class Visit>
void for_each_point(const SurfacePoints& points, const Progress& progress, const Visit& visit)
{
    CellView view;
    for (const SurfaceCell& cell : points.cells()) {
        tell(progress, double(&cell - points.cells().data()) / double(points.cells().size()));
        view.load(points, cell);
        view.for_each_point([&](const glm::ivec3& corner, uint32_t point) { visit(view, corner, point); });
    }
}

/// The number of different groups around the edge upwards along `axis`, with unpainted voxels as one.
int groups_around(const std::array<uint8_t, 8>& octants, int axis)
{
    std::array<uint8_t, 4> groups{};
    for (size_t i = 0, octant = 0; octant < octants.size(); ++octant)
        if ((octant >> axis & 1) != 0) groups[i++] = octants[octant];
    std::ranges::sort(groups);
    return int(std::unique(groups.begin(), groups.end()) - groups.begin());
}

/// The neighbours that a point follows: along lines where three groups meet, if two or more such lines end at it.
Neighbours neighbours_of(const SurfacePoints& points, const Progress& progress)
{
    Neighbours all(points.count(), {NONE, NONE, NONE, NONE, NONE, NONE});
    std::vector<uint8_t> lines(points.count(), 0);  // bit i: neighbour i is along such a line
    for_each_point(points, progress, [&](const CellView& view, const glm::ivec3& corner, uint32_t point) {
        const std::array<uint8_t, 8> octants = view.octants(corner);
        for (int axis = 0; axis < 3; ++axis) {
            const int groups = groups_around(octants, axis);
            if (groups == 1) continue;
            glm::ivec3 other = corner;
            ++other[axis];
            const uint32_t above = view.point(other);
            const size_t up = size_t(2 * axis + 1), down = size_t(2 * axis);
            all[point][up] = above;
            all[above][down] = point;
            if (groups == 2) continue;
            lines[point] = uint8_t(lines[point] | 1 << up);
            lines[above] = uint8_t(lines[above] | 1 << down);
        }
    });
    for (uint32_t point = 0; point < points.count(); ++point)
        if (std::popcount(lines[point]) >= 2)
            for (size_t i = 0; i < 6; ++i)
                if ((lines[point] >> i & 1) == 0) all[point][i] = NONE;
    return all;
}

glm::vec3 limited(const glm::vec3& offset)
{
    return glm::clamp(offset, glm::vec3(-MAX_SURFACE_OFFSET), glm::vec3(MAX_SURFACE_OFFSET));
}

SurfaceOffsets relaxed(const SurfacePoints& points, int steps, const Progress& progress)
{
    const Neighbours neighbours = neighbours_of(points, part_of(progress, 0.0, 0.3));
    SurfaceOffsets offsets(points.count(), glm::vec3(0.0F)), next(points.count());
    for (int step = 0; step < steps; ++step) {
        for (uint32_t point = 0; point < points.count(); ++point) {
            if (point % (1U << 20) == 0) tell(progress, 0.3 + 0.7 * double(step) / double(steps));
            glm::vec3 sum(0.0F);
            float count = 0.0F;
            for (int i = 0; i < 6; ++i) {
                const uint32_t other = neighbours[point][size_t(i)];
                if (other == NONE) continue;
                sum += offsets[other];
                sum[i / 2] += i % 2 == 0 ? -1.0F : 1.0F;
                count += 1.0F;
            }
            next[point] = limited(0.5F * (offsets[point] + sum / count));
        }
        offsets.swap(next);
    }
    return offsets;
}

/// The normal of a group at an unmoved point: by how much its volume grows if the point moves, in voxels.
glm::dvec3 normal_of(const std::array<uint8_t, 8>& octants, uint8_t group)
{
    glm::dvec3 normal(0.0);
    for (size_t octant = 0; octant < octants.size(); ++octant)
        for (int axis = 0; axis < 3; ++axis) {
            const size_t other = octant ^ size_t { 1 } << axis;
            if (octants[octant] != group || octants[other] == group) continue;
            normal[axis] += (octant >> axis & 1) == 0 ? 0.25 : -0.25;
        }
    return normal;
}

/// Calls `visit(group, normal)` for each group at a corner.
template <class Visit>
void for_each_normal(const std::array<uint8_t, 8>& octants, const Visit& visit)
{
    for (size_t i = 0; i < octants.size(); ++i)
        if (octants[i] != 0 && std::find(octants.begin(), octants.begin() + i, octants[i]) == octants.begin() + i)
            visit(octants[i], normal_of(octants, octants[i]));
}

/// Solves a symmetric system without pivoting; unknowns that it does not determine become 0.
std::vector<double> solved(std::vector<std::vector<double>> matrix, std::vector<double> right)
{
    const size_t size = right.size();
    std::vector<bool> is_free(size, false);
    double largest = 0.0;
    for (size_t i = 0; i < size; ++i) largest = std::max(largest, matrix[i][i]);
    for (size_t i = 0; i < size; ++i) {
        is_free[i] = matrix[i][i] <= 1e-12 * largest;
        for (size_t row = i + 1; row < size && !is_free[i]; ++row) {
            const double factor = matrix[row][i] / matrix[i][i];
            for (size_t column = i; column < size; ++column) matrix[row][column] -= factor * matrix[i][column];
            right[row] -= factor * right[i];
        }
    }
    for (size_t i = size; i-- > 0;) {
        for (size_t column = i + 1; column < size; ++column) right[i] -= matrix[i][column] * right[column];
        right[i] = is_free[i] ? 0.0 : right[i] / matrix[i][i];
    }
    return right;
}

class VolumeKeeper {
public:
    VolumeKeeper(const SurfacePoints& points, const glm::dvec3& spacing) : points_(points), spacing_(spacing)
    {
        for (size_t group = 1; group < 256; ++group) {
            if (points.mask().voxels_by_group()[group] == 0) continue;
            place_[group] = groups_.size();
            groups_.push_back(uint8_t(group));
        }
    }

    /// Moves points along normals, each group by one factor, until the volumes are nearly those of the voxels.
    void move(SurfaceOffsets& offsets, const Progress& progress)
    {
        constexpr int TRIES = 12;
        constexpr double CLOSE = 1e-4;
        std::vector<std::vector<double>> matrix(groups_.size(), std::vector<double>(groups_.size(), 0.0));
        for_each_point(points_, part_of(progress, 0.0, 0.1),
                       [&](const CellView& view, const glm::ivec3& corner, uint32_t) {
                           const std::array<uint8_t, 8> octants = view.octants(corner);
                           for_each_normal(octants, [&](uint8_t a, const glm::dvec3& of_a) {
                               for_each_normal(octants, [&](uint8_t b, const glm::dvec3& of_b) {
                                   matrix[place_[a]][place_[b]] += glm::dot(of_a, of_b);
                               });
                           });
                       });
        for (int i = 0; i < TRIES; ++i) {
            const double done = 0.1 + 0.8 * double(i) / TRIES;
            const std::vector<double> missing = missing_volumes(offsets, part_of(progress, done, done + 0.04));
            if (worst(missing) <= CLOSE) return;
            const std::vector<double> factors = solved(matrix, missing);
            for_each_point(points_, {}, [&](const CellView& view, const glm::ivec3& corner, uint32_t point) {
                glm::dvec3 step(0.0);
                for_each_normal(view.octants(corner), [&](uint8_t group, const glm::dvec3& normal) {
                    step += factors[place_[group]] * normal;
                });
                offsets[point] = limited(offsets[point] + glm::vec3(step));
            });
        }
    }

    /// Takes points of groups whose volumes still differ too much back towards their corners, where volumes are exact.
    void take_back(SurfaceOffsets& offsets, const Progress& progress)
    {
        constexpr int HALVINGS = 6;
        for (int i = 0;; ++i) {
            const std::vector<double> missing = missing_volumes(offsets, progress);
            if (worst(missing) <= MAX_VOLUME_CHANGE) return;
            const float factor = i < HALVINGS ? 0.5F : 0.0F;
            for_each_point(points_, {}, [&](const CellView& view, const glm::ivec3& corner, uint32_t point) {
                const bool is_off = std::ranges::any_of(view.octants(corner), [&](uint8_t group) {
                    return group != 0 && change(missing, place_[group]) > MAX_VOLUME_CHANGE;
                });
                if (is_off) offsets[point] *= factor;
            });
        }
    }

private:
    std::vector<double> missing_volumes(const SurfaceOffsets& offsets, const Progress& progress) const
    {
        const std::array<double, 256> volumes = enclosed_volumes(points_, offsets, spacing_, progress);
        std::vector<double> missing;
        for (const uint8_t group : groups_) missing.push_back(voxels(group) - volumes[group]);
        return missing;
    }
    double voxels(uint8_t group) const { return double(points_.mask().voxels_by_group()[group]); }
    double change(const std::vector<double>& missing, size_t place) const
    {
        return std::abs(missing[place]) / voxels(groups_[place]);
    }
    double worst(const std::vector<double>& missing) const
    {
        double most = 0.0;
        for (size_t i = 0; i < missing.size(); ++i) most = std::max(most, change(missing, i));
        return most;
    }

    const SurfacePoints& points_;
    glm::dvec3 spacing_;
    std::vector<uint8_t> groups_;
    std::array<size_t, 256> place_{};
};

}  // namespace

std::array<double, 256> enclosed_volumes(const SurfacePoints& points, const SurfaceOffsets& offsets,
                                         const glm::dvec3& spacing, const Progress& progress)
{
    std::array<double, 256> volumes{};
    CellView view;
    for (const SurfaceCell& cell : points.cells()) {
        tell(progress, double(&cell - points.cells().data()) / double(points.cells().size()));
        view.load(points, cell);
        for_each_face(points, view, offsets, [&](const SurfaceFace& face) {
            const FaceTriangles triangles = triangles_of(face, spacing);
            double volume = 0.0;
            for (int i = 0; i < triangles.count; ++i) {
                const auto& [a, b, c] = triangles.vertices[size_t(i)];
                volume += glm::dot(face.at[a], glm::cross(face.at[b], face.at[c])) / 6.0;
            }
            volumes[face.below] += volume;
            volumes[face.above] -= volume;
        });
    }
    return volumes;
}

SurfaceOffsets smoothed(const SurfacePoints& points, int steps, const glm::dvec3& spacing, const Progress& progress)
{
    if (steps == 0) return SurfaceOffsets(points.count(), glm::vec3(0.0F));
    SurfaceOffsets offsets = relaxed(points, steps, part_of(progress, 0.0, 0.4));
    VolumeKeeper keeper(points, spacing);
    keeper.move(offsets, part_of(progress, 0.4, 0.9));
    keeper.take_back(offsets, part_of(progress, 0.9, 1.0));
    return offsets;
}

}  // namespace shvr
