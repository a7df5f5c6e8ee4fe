// Holes of a group: components, connected over faces, of voxels outside the group that do not reach the volume's
// border. Bricks without the group are not visited one by one: between two bricks of the group in a row of bricks they
// form a gap, one node of the union-find. Rows of bricks without the group reach the border, as do the bricks of a row
// before its first and after its last brick of the group. The cost depends on the group's bricks and the holes.

#include <map>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/sets/brick_components.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

class Outside {
public:
    Outside(const Mask& mask, MaskEdit& edit, uint8_t group, const Progress& progress);
    bool is_hole(uint32_t label) { return components_.root_of(label) != components_.root_of(outside_); }
    /// Calls `fill(brick, bits, is_whole)` for each brick with voxels of holes. `is_whole`: all voxels of the brick are
    /// in a hole; otherwise only those of `bits`. Returns the number of holes.
    template <class Fill>
    int64_t for_each_hole(const Fill& fill);

private:
    /// The group's bricks in one row of bricks, by x, each with the label of the gap on its left.
    using Row = std::map<int64_t, uint32_t>;
    const Row* row_at(int64_t y, int64_t z) const
    {
        const auto found = rows_.find({z, y});
        return found == rows_.end() ? nullptr : &found->second;
    }
    /// The label of a brick without voxels of the group, or of a position beyond the border.
    uint32_t label_of_gap(const Size3& at) const;
    void join_brick(int64_t brick);
    void join_gap(const Size3& from, int64_t to_x, uint32_t label);

    const Mask& mask_;
    Size3 counts_;
    BrickComponents components_;
    uint32_t outside_;
    std::map<std::pair<int64_t, int64_t>, Row> rows_;  ///< by z and y
};

Outside::Outside(const Mask& mask, MaskEdit& edit, uint8_t group, const Progress& progress)
    : mask_(mask), counts_(mask.brick_counts()), components_(counts_, 6), outside_(components_.add_label())
{
    for_each_brick(mask, part_of(progress, 0.0, 0.5), [&](int64_t brick) {
        BrickBits bits = bits_of(edit.read(brick), group);
        if (is_empty(bits)) return;
        const BrickBits inside = bits_inside(mask_.box_of(brick).size());
        for (size_t row = 0; row < bits.size(); ++row) bits[row] = inside[row] & ~bits[row];
        components_.add(brick, bits);
        const Size3 at = position_of(brick, counts_);
        Row& row = rows_[{at.z, at.y}];
        const bool is_gap = !row.empty() && row.rbegin()->first + 1 < at.x;
        row.emplace(at.x, is_gap ? components_.add_label() : outside_);
    });
    const std::vector<int64_t> bricks = components_.bricks();
    for_each_brick(bricks, part_of(progress, 0.5, 1.0), [&](int64_t brick) { join_brick(brick); });
    for (const auto& [at, row] : rows_) {
        int64_t left = 0;
        for (const auto& [x, label] : row) {
            if (label != outside_) join_gap({left + 1, at.second, at.first}, x, label);
            left = x;
        }
    }
}

uint32_t Outside::label_of_gap(const Size3& at) const
{
    const Row* const row = row_at(at.y, at.z);
    if (!row) return outside_;
    const auto right = row->upper_bound(at.x);
    return right == row->end() || right == row->begin() ? outside_ : right->second;
}

/// Joins the voxels on the brick's faces to neighbouring gaps, and to the outside at the volume's border.
void Outside::join_brick(int64_t brick)
{
    const Size3 at = position_of(brick, counts_), extent = mask_.box_of(brick).size();
    for (int axis = 0; axis < 3; ++axis)
        for (const int64_t step : {-1, 1}) {
            Size3 next = at;
            next[axis] += step;
            const int64_t face = step < 0 ? 0 : extent[axis] - 1;
            const bool is_beyond = next[axis] < 0 || next[axis] >= counts_[axis];
            if (is_beyond)
                components_.join_face(brick, axis, face, outside_);
            else if (!components_.has(index_of(next, counts_)))
                components_.join_face(brick, axis, face, label_of_gap(next));
        }
}

/// Joins a gap, the bricks from `from` up to x = `to_x`, with the gaps next to it in neighbouring rows of bricks.
void Outside::join_gap(const Size3& from, int64_t to_x, uint32_t label)
{
    for (const Size3& step : {Size3(0, -1, 0), Size3(0, 1, 0), Size3(0, 0, -1), Size3(0, 0, 1)}) {
        const Size3 beside = from + step;
        const Row* const row = row_at(beside.y, beside.z);
        if (!row) {  // also beyond the border
            components_.join(label, outside_);
            continue;
        }
        // The neighbouring row's gaps touching this gap: the one at `from`, and those after its bricks before `to_x`.
        if (!row->contains(from.x)) components_.join(label, label_of_gap(beside));
        for (auto brick = row->lower_bound(from.x); brick != row->end() && brick->first + 1 < to_x; ++brick) {
            const int64_t after = brick->first + 1;
            if (!row->contains(after)) components_.join(label, label_of_gap({after, beside.y, beside.z}));
        }
    }
}

template <class Fill>
int64_t Outside::for_each_hole(const Fill& fill)
{
    std::map<uint32_t, bool> holes;
    for (const auto& [at, row] : rows_) {
        int64_t left = 0;
        for (const auto& [x, label] : row) {
            if (label != outside_ && is_hole(label)) {
                holes[components_.root_of(label)] = true;
                for (int64_t gap = left + 1; gap < x; ++gap)
                    fill(index_of(Size3(gap, at.second, at.first), counts_), BrickBits{}, true);
            }
            left = x;
            const int64_t brick = index_of(Size3(x, at.second, at.first), counts_);
            BrickBits bits{};
            for (size_t index = 0; index < bits.size(); ++index)
                for (const BrickComponents::Run& run : components_.runs(brick, index))
                    if (is_hole(run.label)) {
                        holes[components_.root_of(run.label)] = true;
                        bits[index] |= (~0u >> (31 - (run.last - run.first))) << run.first;
                    }
            if (!is_empty(bits)) fill(brick, bits, false);
        }
    }
    return int64_t(holes.size());
}

}  // namespace

void perform(const FillHolesOp& op, MaskEdit& edit, const Progress& progress)
{
    const auto group = uint8_t(op.group);
    Outside outside(edit.mask(), edit, group, part_of(progress, 0.0, 0.7));
    const int64_t holes = outside.for_each_hole([&](int64_t brick, const BrickBits& bits, bool is_whole) {
        if (!edit.may_change(brick)) return;
        tell(progress, 0.7);  // may end the operation
        MaskBrick wanted = edit.read(brick);
        for (size_t i = 0; i < wanted.size(); ++i)
            if (is_whole || (bits[i / 32] >> (i % 32) & 1u) != 0) wanted[i] = group;
        edit.want(brick, wanted);
    });
    edit.note(holes == 0 ? "the group encloses nothing" : counted(holes, "hole"));
}

}  // namespace shvr
