#include "engine/annotation/density.h"

#include <algorithm>
#include <cmath>

#include "engine/annotation/brick_run.h"
#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {}  // namespace

int64_t DensityBrickChange::voxels() const
{
    int64_t sum = 0;
    for (const DensityRun& run : runs) sum += run.last - run.first + 1;
    return sum;
}

DensityField::DensityField(Size3 size, VoxelType type)
    : size_(size), type_(type), counts_((size + Size3(BRICK_SIDE - 1)) / Size3(BRICK_SIDE))
{}

glm::ivec3 DensityField::position_of(int64_t brick) const
{
    return {int(brick % counts_.x), int(brick / counts_.x % counts_.y), int(brick / (counts_.x * counts_.y))};
}

Size3 DensityField::extent_of(int64_t brick) const
{
    SHVR_CHECK(brick >= 0 && brick < counts_.x * counts_.y * counts_.z, "brick ", brick);
    return glm::min(Size3(BRICK_SIDE), size_ - BRICK_SIDE * Size3(position_of(brick)));
}

double DensityField::at(const Size3& voxel) const
{
    SHVR_CHECK(glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, size_)), "voxel ",
               voxel.x, ", ", voxel.y, ", ", voxel.z);
    const Size3 where = voxel / BRICK_SIDE, in = voxel % BRICK_SIDE;
    const auto found = bricks_.find(index_of(where, counts_));
    return found == bricks_.end()
               ? 0.0
               : offset_of(type_, (*found->second)[size_t(in.x + BRICK_SIDE * (in.y + BRICK_SIDE * in.z))]);
}

std::shared_ptr<const OffsetBrick> DensityField::brick(int64_t index) const
{
    const auto found = bricks_.find(index);
    return found == bricks_.end() ? nullptr : found->second;
}

std::vector<int64_t> DensityField::painted_bricks() const
{
    std::vector<int64_t> indices;
    for (const auto& [index, brick] : bricks_) indices.push_back(index);
    return indices;
}

std::string DensityField::misfit(const DensityBrickChange& change, Direction direction) const
{
    if (change.brick < 0 || change.brick >= counts_.x * counts_.y * counts_.z)
        return sentence("there is no brick ", change.brick);
    const Size3 extent = extent_of(change.brick);
    const std::shared_ptr<const OffsetBrick> held = brick(change.brick);
    const bool forwards = direction == Direction::forwards;
    const double limit = offset_limit(type_);
    int64_t free_from = 0;  // where the next run may begin
    for (const DensityRun& run : change.runs) {
        const uint32_t from = forwards ? run.before : run.after, to = forwards ? run.after : run.before;
        if (free_from > run.first || run.first > run.last || run.last >= MASK_BRICK_VOXELS ||
            !run_is_inside(run.first, run.last, extent))
            return sentence("brick ", change.brick, " has no run ", run.first, " ... ", run.last, " there");
        const auto holds = [&](uint32_t bits) { return bits == from; };
        if (held ? !std::all_of(held->begin() + run.first, held->begin() + run.last + 1, holds) : !holds(0))
            return sentence("brick ", change.brick, " does not hold offset ", offset_of(type_, from), " at ", run.first,
                            " ... ", run.last);
        if (!(std::abs(offset_of(type_, to)) <= limit))
            return sentence("brick ", change.brick, " is to hold offset ", offset_of(type_, to));
        free_from = run.last + 1;
    }
    return {};
}

void DensityField::apply(const DensityBrickChange& change, Direction direction)
{
    const std::string misfits = misfit(change, direction);
    SHVR_CHECK(misfits.empty(), misfits);
    const std::shared_ptr<const OffsetBrick> held = brick(change.brick);
    const auto changed = held ? std::make_shared<OffsetBrick>(*held) : std::make_shared<OffsetBrick>();
    const bool forwards = direction == Direction::forwards;
    for (const DensityRun& run : change.runs) {
        const uint32_t from = forwards ? run.before : run.after, to = forwards ? run.after : run.before;
        std::fill(changed->begin() + run.first, changed->begin() + run.last + 1, to);
        voxels_ += (run.last - run.first + 1) * (int(to != 0) - int(from != 0));
    }
    if (std::all_of(changed->begin(), changed->end(), [](uint32_t bits) { return bits == 0; }))
        bricks_.erase(change.brick);
    else
        bricks_[change.brick] = changed;
}

void DensityField::put(int64_t index, OffsetBrick offsets)
{
    SHVR_CHECK(!bricks_.contains(index), "brick ", index, " has offsets");
    const Size3 extent = extent_of(index);
    int64_t voxels = 0;
    for (int64_t i = 0; i < int64_t(offsets.size()); ++i) {
        const Size3 in(i % BRICK_SIDE, i / BRICK_SIDE % BRICK_SIDE, i / (BRICK_SIDE * BRICK_SIDE));
        uint32_t& bits = offsets[size_t(i)];
        if (!glm::all(glm::lessThan(in, extent))) bits = 0;
        voxels += bits != 0;
    }
    if (voxels == 0) return;
    voxels_ += voxels;
    bricks_[index] = std::make_shared<OffsetBrick>(offsets);
}

VoxelBox DensityField::reach_of(const DensityBrickChange& change) const
{
    Size3 lower(BRICK_SIDE), upper(0);
    for (const DensityRun& run : change.runs) {
        Size3 first(run.first % BRICK_SIDE, run.first / BRICK_SIDE % BRICK_SIDE, run.first / (BRICK_SIDE * BRICK_SIDE));
        Size3 last(run.last % BRICK_SIDE, run.last / BRICK_SIDE % BRICK_SIDE, run.last / (BRICK_SIDE * BRICK_SIDE));
        // A run that goes on in the next row, or slice, may hold all columns, or rows.
        if (first.z != last.z) first.y = 0, last.y = BRICK_SIDE - 1;
        if (run.first / BRICK_SIDE != run.last / BRICK_SIDE) first.x = 0, last.x = BRICK_SIDE - 1;
        lower = glm::min(lower, first);
        upper = glm::max(upper, last + int64_t{1});
    }
    const Size3 corner = BRICK_SIDE * Size3(position_of(change.brick));
    return {corner + lower, glm::min(corner + upper, size_)};
}

}  // namespace shvr
