#include "engine/annotation/sparse_bricks.h"

#include "engine/base/error.h"

namespace shvr {

namespace {

bool is_zero(auto value)
{
    return value == 0;
}

Size3 place_in_brick(int64_t index)
{
    return position_of(index, Size3(BRICK_SIDE));
}

/// Whether voxels `first` to `last` lie in the volume; `extent` is the size of the brick's part inside the volume.
bool run_is_inside(int64_t first, int64_t last, const Size3& extent)
{
    const Size3 begin = place_in_brick(first), end = place_in_brick(last);
    // Runs are contiguous: a run over several rows needs all columns of the brick, a run over several slices all rows.
    const bool rows_are_full = extent.x == BRICK_SIDE || first / BRICK_SIDE == last / BRICK_SIDE;
    const bool slices_are_full = extent.y == BRICK_SIDE || begin.z == end.z;
    return rows_are_full && slices_are_full && glm::all(glm::lessThan(begin, extent)) &&
           glm::all(glm::lessThan(end, extent));
}

}  // namespace

template <class Value>
int64_t BrickChange<Value>::voxels() const
{
    int64_t sum = 0;
    for (const BrickRun<Value>& run : runs) sum += run.last - run.first + 1;
    return sum;
}

template <class Value>
VoxelBox SparseBricks<Value>::box_of(int64_t brick) const
{
    SHVR_CHECK(holds_brick(brick), "brick ", brick);
    const Size3 lower = BRICK_SIDE * Size3(position_of(brick));
    return {lower, glm::min(lower + BRICK_SIDE, size_)};
}

template <class Value>
Value SparseBricks<Value>::value_at(const Size3& voxel) const
{
    SHVR_CHECK(glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, size_)), "voxel ",
               voxel.x, ", ", voxel.y, ", ", voxel.z);
    const std::shared_ptr<const Brick>& found = brick(index_of(voxel / BRICK_SIDE, counts_));
    return found ? (*found)[index_in_brick(voxel)] : Value{0};
}

template <class Value>
auto SparseBricks<Value>::brick(int64_t index) const -> const std::shared_ptr<const Brick>&
{
    static const std::shared_ptr<const Brick> NONE;
    const auto found = bricks_.find(index);
    return found == bricks_.end() ? NONE : found->second;
}

template <class Value>
std::vector<int64_t> SparseBricks<Value>::painted_bricks() const
{
    std::vector<int64_t> indices;
    for (const auto& [index, brick] : bricks_) indices.push_back(index);
    return indices;
}

template <class Value>
VoxelBox SparseBricks<Value>::reach_of(const BrickChange<Value>& change) const
{
    Size3 lower(BRICK_SIDE), upper(0);
    for (const BrickRun<Value>& run : change.runs) {
        Size3 first = place_in_brick(run.first), last = place_in_brick(run.last);
        // The box of a run over several rows includes all columns; that of a run over several slices includes all rows.
        if (first.z != last.z) first.y = 0, last.y = BRICK_SIDE - 1;
        if (run.first / BRICK_SIDE != run.last / BRICK_SIDE) first.x = 0, last.x = BRICK_SIDE - 1;
        lower = glm::min(lower, first);
        upper = glm::max(upper, last + int64_t{1});
    }
    const Size3 corner = box_of(change.brick).lower;
    return {corner + lower, glm::min(corner + upper, size_)};
}

template <class Value>
std::string SparseBricks<Value>::why_it_does_not_fit(const BrickChange<Value>& change, Direction direction,
                                                     const Named& named, const Allowed& allowed) const
{
    if (!holds_brick(change.brick)) return sentence("there is no brick ", change.brick);
    const Size3 extent = box_of(change.brick).size();
    const std::shared_ptr<const Brick>& held = brick(change.brick);
    const bool forwards = direction == Direction::forwards;
    int64_t free_from = 0;  // where the next run may begin
    for (const BrickRun<Value>& run : change.runs) {
        const Value from = forwards ? run.before : run.after, to = forwards ? run.after : run.before;
        if (free_from > run.first || run.first > run.last || run.last >= VOXELS_PER_BRICK ||
            !run_is_inside(run.first, run.last, extent))
            return sentence("brick ", change.brick, " has no run ", run.first, " ... ", run.last, " there");
        const auto holds = [&](Value value) { return value == from; };
        if (held ? !std::all_of(held->begin() + run.first, held->begin() + run.last + 1, holds) : !holds(0))
            return sentence("brick ", change.brick, " does not hold ", named(from), " at ", run.first, " ... ",
                            run.last);
        if (allowed && !allowed(to)) return sentence("brick ", change.brick, " is to hold ", named(to));
        free_from = run.last + 1;
    }
    return {};
}

template <class Value>
int64_t SparseBricks<Value>::put(int64_t index, Brick values)
{
    SHVR_CHECK(!brick(index), "brick ", index, " is there already");
    const Size3 extent = box_of(index).size();
    int64_t voxels = 0;
    for (size_t i = 0; i < values.size(); ++i) {
        if (!glm::all(glm::lessThan(place_in_brick(int64_t(i)), extent))) values[i] = 0;
        voxels += values[i] != 0;
    }
    if (voxels > 0) store(index, std::make_shared<Brick>(values));
    return voxels;
}

template <class Value>
void SparseBricks<Value>::store(int64_t index, std::shared_ptr<const Brick> brick)
{
    if (std::all_of(brick->begin(), brick->end(), is_zero<Value>))
        bricks_.erase(index);
    else
        bricks_[index] = std::move(brick);
}

template struct BrickChange<uint8_t>;
template struct BrickChange<uint32_t>;
template class SparseBricks<uint8_t>;
template class SparseBricks<uint32_t>;

}  // namespace shvr
