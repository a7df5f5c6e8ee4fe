#pragma once
// Masks for tests of operations on groups, and the comparison with tests/reference/group_operations.h.

#include <algorithm>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "engine/annotation/operations/run_operation.h"
#include "tests/reference/group_operations.h"

namespace shvr::test {

using reference::DenseGroups;

inline DenseGroups dense_of(const Mask& mask)
{
    DenseGroups dense{mask.size(), {}};
    reference::for_each_voxel(mask.size(), [&](const Size3& voxel) { dense.groups.push_back(mask.at(voxel)); });
    return dense;
}

inline void apply(Mask& mask, const std::vector<MaskBrickChange>& changes, Direction direction = Direction::forwards)
{
    for (const MaskBrickChange& change : changes) mask.apply(change, direction);
}

inline Mask mask_of(const DenseGroups& dense)
{
    Mask mask(dense.size);
    for (int64_t brick = 0; brick < mask.brick_counts().x * mask.brick_counts().y * mask.brick_counts().z; ++brick) {
        const VoxelBox box = mask.box_of(brick);
        MaskBrickChange change{.brick = brick, .runs = {}};
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x) {
                    const size_t index = index_in_brick({x, y, z});
                    append_run(change.runs, index, index, uint8_t{0}, dense.at({x, y, z}));
                }
        if (!change.runs.empty()) mask.apply(change, Direction::forwards);
    }
    return mask;
}

/// A volume whose intensities are a function of the position.
class PatternSource final : public VolumeSource {
public:
    static VolumeInfo info_of(const Size3& size, const glm::dvec3& spacing)
    {
        VolumeInfo info;
        info.name = "pattern";
        info.size = size;
        info.spacing = spacing;
        info.unit = "mm";
        return info;
    }
    PatternSource(const Size3& size, const glm::dvec3& spacing) : VolumeSource(info_of(size, spacing)) {}
    static uint8_t value_at(const Size3& voxel) { return uint8_t((voxel.x * 7 + voxel.y * 13 + voxel.z * 29) % 251); }
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        size_t next = 0;
        reference::for_each_voxel(box.size(),
                                  [&](const Size3& voxel) { voxels[next++] = std::byte{value_at(box.lower + voxel)}; });
    }
};

/// What the limits and locks let the operation do: the definition, voxel by voxel.
inline DenseGroups limited(const DenseGroups& before, DenseGroups wanted, const OperationLimits& limits,
                           const GroupSet& locked, const glm::dvec3& spacing)
{
    reference::for_each_voxel(before.size, [&](const Size3& voxel) {
        const uint8_t held = before.at(voxel);
        const double value = PatternSource::value_at(voxel);
        const bool may = !locked[held] && !locked[wanted.at(voxel)] && (!limits.only_unpainted || held == 0) &&
                         (!limits.inside || *limits.inside == held) &&
                         (!limits.within || (value >= limits.within->x && value <= limits.within->y)) &&
                         (!limits.box || (glm::all(glm::greaterThanEqual(voxel, limits.box->lower)) &&
                                          glm::all(glm::lessThan(voxel, limits.box->upper)))) &&
                         reference::is_behind_plane(voxel, limits, spacing);
        if (!may) wanted.at(voxel) = held;
    });
    return wanted;
}

/// Runs the operation, compares the result with the reference, and takes it back.
inline OperationResult check_operation(const GroupOperation& operation, const DenseGroups& before,
                                       const glm::dvec3& spacing = {1, 1, 1}, const GroupSet& locked = {},
                                       const TraceGraph* trace = nullptr)
{
    Mask mask = mask_of(before);
    const PatternSource source(before.size, spacing);
    const OperationInput input{
        .mask = mask, .volume = source.info(), .source = &source, .trace = trace, .locked = locked};
    const OperationResult result = run(operation, input);
    const OperationLimits limits = std::visit(
        [](const auto& op) {
            if constexpr (requires { op.limits; })
                return op.limits;
            else
                return OperationLimits{};
        },
        operation);
    reference::DenseVolume volume{spacing, {}, trace, locked};
    reference::for_each_voxel(
        before.size, [&](const Size3& voxel) { volume.intensities.push_back(PatternSource::value_at(voxel)); });
    const DenseGroups expected = limited(before, reference::wanted(operation, before, volume), limits, locked, spacing);
    apply(mask, result.changes);
    CHECK((dense_of(mask).groups == expected.groups));
    int64_t changed = 0;
    for (size_t i = 0; i < expected.groups.size(); ++i) changed += expected.groups[i] != before.groups[i];
    CHECK(result.voxels == changed);
    CHECK(result.bricks_written == int64_t(result.changes.size()));
    apply(mask, result.changes, Direction::backwards);
    CHECK((dense_of(mask).groups == before.groups));
    return result;
}

/// Random balls of the groups 1 ... 4 and unpainted ones, and single voxels.
inline DenseGroups random_groups(std::mt19937& random, const Size3& size, int balls = 12)
{
    DenseGroups dense{size, std::vector<uint8_t>(size_t(size.x * size.y * size.z))};
    const auto below = [&](int64_t limit) { return int64_t(random() % uint64_t(limit)); };
    for (int i = 0; i < balls; ++i) {
        const Size3 centre(below(size.x), below(size.y), below(size.z));
        const int64_t radius = 1 + below(14);
        const auto group = uint8_t(below(5));
        const Size3 lower = glm::max(centre - radius, Size3(0)), upper = glm::min(centre + radius + int64_t{1}, size);
        reference::for_each_voxel(upper - lower, [&](const Size3& step) {
            const Size3 from = lower + step - centre;
            if (from.x * from.x + from.y * from.y + from.z * from.z <= radius * radius) dense.at(lower + step) = group;
        });
    }
    for (int i = 0; i < 60; ++i) dense.at({below(size.x), below(size.y), below(size.z)}) = uint8_t(below(5));
    return dense;
}

inline VoxelBox box_reaching_out_of(const Size3& size)
{
    return {{-3, std::min<int64_t>(5, size.y - 1), std::min<int64_t>(7, size.z - 1)},
            {std::max<int64_t>(size.x - 9, 1), size.y + 4, 40}};
}

inline OperationLimits random_limits(std::mt19937& random, const Size3& size)
{
    OperationLimits limits;
    if (random() % 3 == 0) limits.within = glm::dvec2(40, 180);
    if (random() % 4 == 0) limits.inside = int64_t(random() % 5);
    limits.only_unpainted = random() % 4 == 0;
    if (random() % 3 == 0) limits.box = box_reaching_out_of(size);
    if (random() % 3 == 0) {
        const auto between = [&](double low, double high) {
            return low + (high - low) * double(random()) / 4294967295.0;
        };
        limits.plane_normal = glm::dvec3(between(-2, 2), between(-2, 2), between(-2, 2));
        limits.plane_point = glm::dvec3(size) * glm::dvec3(between(0.2, 0.8), between(0.2, 0.8), between(0.2, 0.8));
    }
    return limits;
}

/// Sizes below, at and above whole bricks, and odd ones.
inline const Size3 ODD_SIZES[] = {{33, 31, 1}, {32, 64, 32}, {70, 37, 45}, {65, 33, 66}};

}  // namespace shvr::test
