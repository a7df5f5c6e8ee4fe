#pragma once
// Operations on groups by their definitions, voxel by voxel on a dense array: slow, and sharing no code with
// engine/annotation/operations.

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/annotation/brush.h"
#include "engine/annotation/operations/operations.h"
#include "engine/annotation/trace/tracing.h"

namespace shvr::reference {

/// The groups of a whole volume, x fastest.
struct DenseGroups {
    Size3 size{0};
    std::vector<uint8_t> groups{};
    uint8_t& at(const Size3& voxel) { return groups[size_t(voxel.x + size.x * (voxel.y + size.y * voxel.z))]; }
    uint8_t at(const Size3& voxel) const { return groups[size_t(voxel.x + size.x * (voxel.y + size.y * voxel.z))]; }
    bool contains(const Size3& voxel) const
    {
        return glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, size));
    }
};

/// Visits x fastest, z slowest.
template <class Visit>
void for_each_voxel(const Size3& size, const Visit& visit)
{
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t x = 0; x < size.x; ++x) visit(Size3(x, y, z));
}

/// The connected components of the voxels for which `is_in` holds, each as its voxels, in the order of first voxels.
std::vector<std::vector<Size3>> components_of(const DenseGroups& dense, const std::function<bool(uint8_t)>& is_in,
                                              int64_t connectivity);

struct DenseVolume {
    glm::dvec3 spacing{1.0};  ///< mm
    std::vector<double> intensities{};
    const TraceGraph* trace = nullptr;
    GroupSet locked{};
};

/// Whether the centre of a voxel is on the limits' plane or on the side where voxels may change; true without a plane.
bool is_behind_plane(const Size3& voxel, const OperationLimits& limits, const glm::dvec3& spacing);

/// The groups that the operation wants, without limits and locks unless they are a part of its definition.
DenseGroups wanted(const GroupOperation& operation, const DenseGroups& before, const DenseVolume& volume);

}  // namespace shvr::reference
