#pragma once
// One value per voxel of a volume, most of them 0, in sparse bricks of 32^3 voxels: the base class of the mask (mask.h)
// and of density offsets (density.h). A brick whose values are all 0 does not exist. Values change only through records
// of the exact states before and after; undo applies the same record backwards.
//
// Bricks are immutable: changing voxels replaces their brick. So copying all bricks copies only the table of pointers,
// and callers may keep a brick as long as they like. One thread owns the bricks and lends them as const; a copy may be
// used on another thread.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/annotation/direction.h"
#include "engine/volume/grid.h"
#include "engine/volume/volume.h"

namespace shvr {

inline constexpr size_t VOXELS_PER_BRICK = size_t(BRICK_SIDE * BRICK_SIDE * BRICK_SIDE);

/// Consecutive voxels of one brick (x fastest) that change from one value to another; `before != after`.
template <class Value>
struct BrickRun {
    uint16_t first = 0;
    uint16_t last = 0;  ///< inclusive
    Value before = 0;
    Value after = 0;
    bool operator==(const BrickRun&) const = default;
};

/// The changes in one brick. Runs ascend and do not overlap.
template <class Value>
struct BrickChange {
    int64_t brick = 0;  ///< linear index in the grid of bricks, x fastest
    std::vector<BrickRun<Value>> runs;
    bool operator==(const BrickChange&) const = default;
    int64_t voxels() const;
};

/// Appends voxels `first` to `last` (inclusive), which must come after the voxels of `runs`. Extends the last run if
/// possible, and omits voxels that keep their value.
template <class Value>
void append_run(std::vector<BrickRun<Value>>& runs, size_t first, size_t last, Value before, Value after)
{
    if (before == after) return;
    if (!runs.empty() && runs.back().last + size_t{1} == first && runs.back().before == before &&
        runs.back().after == after)
        runs.back().last = uint16_t(last);
    else
        runs.push_back({uint16_t(first), uint16_t(last), before, after});
}

/// Appends runs that set voxels of an empty brick to the values of `row`, from voxel `first` on.
template <class Value>
void append_painted_runs(std::vector<BrickRun<Value>>& runs, std::span<const std::type_identity_t<Value>> row,
                         size_t first)
{
    for (size_t x = 0; x < row.size();) {
        size_t end = x + 1;
        while (end < row.size() && row[end] == row[x]) ++end;
        append_run(runs, first + x, first + end - 1, Value{0}, row[x]);
        x = end;
    }
}

/// The linear index, within its brick, of a voxel of the volume.
inline size_t index_in_brick(const Size3& voxel)
{
    return size_t(index_of(voxel % BRICK_SIDE, Size3(BRICK_SIDE)));
}

template <class Value>
class SparseBricks {
public:
    using Brick = std::array<Value, VOXELS_PER_BRICK>;  ///< x fastest

    /// The bricks of a volume without voxels.
    SparseBricks() = default;
    explicit SparseBricks(const Size3& size) : size_(size), counts_(brick_grid(size)) {}

    Size3 size() const { return size_; }
    Size3 brick_counts() const { return counts_; }
    glm::ivec3 position_of(int64_t brick) const { return shvr::position_of(brick, counts_); }
    /// The voxels of a brick, clipped to the volume.
    VoxelBox box_of(int64_t brick) const;

    /// The brick, or null if all its values are 0.
    const std::shared_ptr<const Brick>& brick(int64_t index) const;
    /// Bricks with a value other than 0, ascending.
    std::vector<int64_t> painted_bricks() const;
    /// A box of the volume that contains the voxels of a change.
    VoxelBox reach_of(const BrickChange<Value>& change) const;

protected:
    /// The value of a voxel of the volume (SHVR_CHECK).
    Value value_at(const Size3& voxel) const;

    /// A function that returns the name of a value for error messages, such as "group 3".
    using Named = std::function<std::string(Value)>;
    /// A function that returns whether voxels may be set to a value; if empty, all values are allowed.
    using Allowed = std::function<bool(Value)>;
    /// Returns why a change cannot be applied; empty if it can. The change's runs must ascend and lie inside the
    /// volume, and their voxels must have the values that the change is to replace.
    std::string why_it_does_not_fit(const BrickChange<Value>& change, Direction direction, const Named& named,
                                    const Allowed& allowed = {}) const;
    /// Applies a change that fits, calling `replaced(from, to, voxels)` for each run. Frees bricks that become all 0.
    template <class Replaced>
    void replace(const BrickChange<Value>& change, Direction direction, const Replaced& replaced);
    /// Adds a brick that must not exist yet (SHVR_CHECK), and returns how many of its voxels are not 0. Voxels beyond
    /// the volume's border are set to 0.
    int64_t put(int64_t index, Brick values);

private:
    bool holds_brick(int64_t brick) const { return brick >= 0 && brick < counts_.x * counts_.y * counts_.z; }
    void store(int64_t index, std::shared_ptr<const Brick> brick);

    Size3 size_{0};
    Size3 counts_{0};
    std::map<int64_t, std::shared_ptr<const Brick>> bricks_;
};

template <class Value>
template <class Replaced>
void SparseBricks<Value>::replace(const BrickChange<Value>& change, Direction direction, const Replaced& replaced)
{
    const std::shared_ptr<const Brick>& held = brick(change.brick);
    const auto changed = held ? std::make_shared<Brick>(*held) : std::make_shared<Brick>();
    const bool forwards = direction == Direction::forwards;
    for (const BrickRun<Value>& run : change.runs) {
        const Value from = forwards ? run.before : run.after, to = forwards ? run.after : run.before;
        std::fill(changed->begin() + run.first, changed->begin() + run.last + 1, to);
        replaced(from, to, int64_t{run.last} - run.first + 1);
    }
    store(change.brick, changed);
}

extern template struct BrickChange<uint8_t>;
extern template struct BrickChange<uint32_t>;
extern template class SparseBricks<uint8_t>;
extern template class SparseBricks<uint32_t>;

}  // namespace shvr
