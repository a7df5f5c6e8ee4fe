#include "engine/annotation/mask.h"

#include <algorithm>

#include "engine/base/error.h"

namespace shvr {

int64_t MaskBrickChange::voxels() const
{
    int64_t sum = 0;
    for (const MaskRun& run : runs) sum += run.last - run.first + 1;
    return sum;
}

Mask::Mask(Size3 size) : size_(size), counts_((size + Size3(gpu::BRICK_SIZE - 1)) / Size3(gpu::BRICK_SIZE))
{
    voxels_by_group_[0] = size.x * size.y * size.z;
}

uint8_t Mask::at(const Size3& voxel) const
{
    const Size3 where = voxel / Size3(gpu::BRICK_SIZE);
    const MaskBrick* found = brick(where.x + counts_.x * (where.y + counts_.y * where.z));
    if (!found) return 0;
    const Size3 in = voxel % Size3(gpu::BRICK_SIZE);
    return (*found)[size_t(in.x + gpu::BRICK_SIZE * (in.y + gpu::BRICK_SIZE * in.z))];
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

void Mask::apply(const MaskBrickChange& change, Direction direction)
{
    SHVR_CHECK(change.brick >= 0 && change.brick < counts_.x * counts_.y * counts_.z, "brick ", change.brick);
    std::unique_ptr<MaskBrick>& brick = bricks_[change.brick];
    if (!brick) brick = std::make_unique<MaskBrick>(MaskBrick{});
    for (const MaskRun& run : change.runs) {
        const bool forwards = direction == Direction::forwards;
        const uint8_t from = forwards ? run.before : run.after, to = forwards ? run.after : run.before;
        SHVR_CHECK(run.first <= run.last && run.last < MASK_BRICK_VOXELS, "run ", run.first, " ... ", run.last);
        const auto begin = brick->begin() + run.first, end = brick->begin() + run.last + 1;
        SHVR_CHECK(std::all_of(begin, end, [&](uint8_t group) { return group == from; }), "brick ", change.brick,
                   " does not hold group ", int(from), " at ", run.first, " ... ", run.last);
        std::fill(begin, end, to);
        voxels_by_group_[from] -= end - begin;
        voxels_by_group_[to] += end - begin;
    }
    if (std::all_of(brick->begin(), brick->end(), [](uint8_t group) { return group == 0; })) bricks_.erase(change.brick);
}

}  // namespace shvr
