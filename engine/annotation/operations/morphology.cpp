// Operations by distance: grow, shrink, open, close and hollow a group.

#include <algorithm>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/sets/voxels_near.h"

namespace shvr {

namespace {

/// Union and difference of two sets: the voxels of `a` with, or without, those of `b`.
BrickSet united(BrickSet a, const BrickSet& b)
{
    for (const auto& [brick, bits] : b) {
        BrickBits& sum = a[brick];
        for (size_t row = 0; row < bits.size(); ++row) sum[row] |= bits[row];
    }
    return a;
}
BrickSet without(BrickSet a, const BrickSet& b)
{
    for (auto& [brick, bits] : a)
        if (const auto found = b.find(brick); found != b.end())
            for (size_t row = 0; row < bits.size(); ++row) bits[row] &= ~found->second[row];
    std::erase_if(a, [](const auto& each) { return is_empty(each.second); });
    return a;
}

/// The bricks of two sets, ascending.
std::vector<int64_t> bricks_of(const BrickSet& a, const BrickSet& b)
{
    std::vector<int64_t> bricks;
    for (const auto& [brick, bits] : a) bricks.push_back(brick);
    for (const auto& [brick, bits] : b)
        if (!a.contains(brick)) bricks.push_back(brick);
    std::ranges::sort(bricks);
    return bricks;
}

BrickSet grown(const BrickSet& set, const Reach& reach, const Progress& progress)
{
    const std::vector<int64_t> bricks = bricks_near(set, reach);
    return voxels_near(set, bricks, reach, progress);
}

BrickSet shrunk(const BrickSet& set, const Reach& reach, const Progress& progress)
{
    return without(set, rim_of(set, reach, progress));
}

/// Passes the group's voxels to `change` as a set, and replaces the group by the set that `change` returns.
template <class Change>
void replace(int64_t group, MaskEdit& edit, const Progress& progress, const Change& change)
{
    BrickSet before;
    for_each_brick(edit.mask(), part_of(progress, 0.0, 0.1), [&](int64_t brick) {
        const BrickBits bits = bits_of(edit.read(brick), uint8_t(group));
        if (!is_empty(bits)) before.emplace(brick, bits);
    });
    const BrickSet after = change(before, part_of(progress, 0.1, 0.8));
    const auto bits_in = [](const BrickSet& set, int64_t brick) {
        const auto found = set.find(brick);
        return found == set.end() ? BrickBits{} : found->second;
    };
    for_each_brick(bricks_of(before, after), part_of(progress, 0.8, 1.0), [&](int64_t brick) {
        if (!edit.may_change(brick)) return;
        MaskBrick wanted = edit.read(brick);
        const BrickBits held = bits_in(before, brick), kept = bits_in(after, brick);
        for (size_t row = 0; row < kept.size(); ++row)
            for (uint32_t left = held[row] ^ kept[row]; left != 0; left &= left - 1) {
                const int x = std::countr_zero(left);
                wanted[32 * row + size_t(x)] = (kept[row] >> x & 1u) != 0 ? uint8_t(group) : uint8_t{0};
            }
        edit.want(brick, wanted);
    });
}

Reach reach_of(const MaskEdit& edit, double distance)
{
    return {edit.mask(), edit.input().volume.spacing, distance};
}

}  // namespace

void perform(const GrowOp& op, MaskEdit& edit, const Progress& progress)
{
    const Reach reach = reach_of(edit, op.distance);
    replace(op.group, edit, progress, [&](const BrickSet& group, const Progress& part) {
        std::vector<int64_t> bricks = bricks_near(group, reach);
        std::erase_if(bricks, [&](int64_t brick) { return !edit.may_change(brick); });
        return united(group, voxels_near(group, bricks, reach, part));
    });
}

void perform(const ShrinkOp& op, MaskEdit& edit, const Progress& progress)
{
    replace(op.group, edit, progress, [&](const BrickSet& group, const Progress& part) {
        return shrunk(group, reach_of(edit, op.distance), part);
    });
}

void perform(const OpenOp& op, MaskEdit& edit, const Progress& progress)
{
    const Reach reach = reach_of(edit, op.distance);
    replace(op.group, edit, progress, [&](const BrickSet& group, const Progress& part) {
        return grown(shrunk(group, reach, part_of(part, 0.0, 0.5)), reach, part_of(part, 0.5, 1.0));
    });
}

void perform(const CloseOp& op, MaskEdit& edit, const Progress& progress)
{
    const Reach reach = reach_of(edit, op.distance);
    replace(op.group, edit, progress, [&](const BrickSet& group, const Progress& part) {
        return shrunk(grown(group, reach, part_of(part, 0.0, 0.5)), reach, part_of(part, 0.5, 1.0));
    });
}

void perform(const HollowOp& op, MaskEdit& edit, const Progress& progress)
{
    const Reach reach = reach_of(edit, op.side == HollowOp::Side::both ? 0.5 * op.wall : op.wall);
    replace(op.group, edit, progress, [&](const BrickSet& group, const Progress& part) {
        BrickSet wall;
        if (op.side != HollowOp::Side::out) wall = rim_of(group, reach, part_of(part, 0.0, 0.5));
        if (op.side != HollowOp::Side::in)
            wall = united(std::move(wall), without(grown(group, reach, part_of(part, 0.5, 1.0)), group));
        return wall;
    });
}

}  // namespace shvr
