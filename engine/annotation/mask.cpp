#include "engine/annotation/mask.h"

#include <algorithm>

#include "engine/annotation/brick_run.h"
#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {}  // namespace

int64_t MaskBrickChange::voxels() const
{
    int64_t sum = 0;
    for (const MaskRun& run : runs) sum += run.last - run.first + 1;
    return sum;
}

void append_painted_runs(std::vector<MaskRun>& runs, std::span<const uint8_t> row, size_t first)
{
    for (size_t x = 0; x < row.size();) {
        const uint8_t group = row[x];
        size_t end = x + 1;
        while (end < row.size() && row[end] == group) ++end;
        if (group != 0) {
            const auto last = uint16_t(first + end - 1);
            if (!runs.empty() && runs.back().last + size_t{1} == first + x && runs.back().after == group)
                runs.back().last = last;
            else
                runs.push_back({uint16_t(first + x), last, 0, group});
        }
        x = end;
    }
}

Mask::Mask(Size3 size) : size_(size), counts_((size + Size3(BRICK_SIDE - 1)) / Size3(BRICK_SIDE))
{
    voxels_by_group_[0] = size.x * size.y * size.z;
}

uint8_t Mask::at(const Size3& voxel) const
{
    SHVR_CHECK(glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, size_)), "voxel ",
               voxel.x, ", ", voxel.y, ", ", voxel.z);
    const Size3 where = voxel / Size3(BRICK_SIDE), in = voxel % Size3(BRICK_SIDE);
    const MaskBrick* found = brick(index_of(where, counts_));
    return found ? (*found)[size_t(in.x + BRICK_SIDE * (in.y + BRICK_SIDE * in.z))] : uint8_t{0};
}

const MaskBrick* Mask::brick(int64_t index) const
{
    const auto found = bricks_.find(index);
    return found == bricks_.end() ? nullptr : found->second.get();
}

std::vector<int64_t> Mask::painted_bricks() const
{
    std::vector<int64_t> indices;
    for (const auto& [index, brick] : bricks_) indices.push_back(index);
    return indices;
}

std::array<int64_t, 256> Mask::voxels_by_group() const
{
    return voxels_by_group_;
}

std::string Mask::misfit(const MaskBrickChange& change, Direction direction) const
{
    if (change.brick < 0 || change.brick >= counts_.x * counts_.y * counts_.z)
        return sentence("there is no brick ", change.brick);
    const Size3 where = position_of(change.brick, counts_);
    const Size3 extent = glm::min(Size3(BRICK_SIDE), size_ - BRICK_SIDE * where);
    const MaskBrick* const held = brick(change.brick);
    int64_t free_from = 0;  // where the next run may begin
    for (const MaskRun& run : change.runs) {
        const uint8_t from = direction == Direction::forwards ? run.before : run.after;
        if (free_from > run.first || run.first > run.last || run.last >= MASK_BRICK_VOXELS ||
            !run_is_inside(run.first, run.last, extent))
            return sentence("brick ", change.brick, " has no run ", run.first, " ... ", run.last, " there");
        const auto holds = [&](uint8_t group) { return group == from; };
        if (held ? !std::all_of(held->begin() + run.first, held->begin() + run.last + 1, holds) : !holds(0))
            return sentence("brick ", change.brick, " does not hold group ", int(from), " at ", run.first, " ... ",
                            run.last);
        free_from = run.last + 1;
    }
    return {};
}

void Mask::apply(const MaskBrickChange& change, Direction direction)
{
    const std::string misfits = misfit(change, direction);
    SHVR_CHECK(misfits.empty(), misfits);
    const MaskBrick* const held = brick(change.brick);
    const auto changed = held ? std::make_shared<MaskBrick>(*held) : std::make_shared<MaskBrick>();
    const bool forwards = direction == Direction::forwards;
    for (const MaskRun& run : change.runs) {
        const uint8_t from = forwards ? run.before : run.after, to = forwards ? run.after : run.before;
        std::fill(changed->begin() + run.first, changed->begin() + run.last + 1, to);
        voxels_by_group_[from] -= run.last - run.first + 1;
        voxels_by_group_[to] += run.last - run.first + 1;
    }
    if (std::all_of(changed->begin(), changed->end(), [](uint8_t group) { return group == 0; }))
        bricks_.erase(change.brick);
    else
        bricks_[change.brick] = changed;
}

}  // namespace shvr
