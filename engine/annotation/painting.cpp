#include "engine/annotation/painting.h"

#include <bit>

namespace shvr {

namespace {

/// Appends runs that give the rule's group to voxels `first` ... `end` - 1 of a brick, except voxels the rule protects.
void append_runs(std::vector<MaskRun>& runs, const MaskBrick& before, size_t first, size_t end, const PaintRule& rule)
{
    while (first < end) {
        size_t next = first + 1;
        while (next < end && before[next] == before[first]) ++next;
        if (rule.fate_of(before[first]) == Fate::changes) append_run(runs, first, next - 1, before[first], rule.group);
        first = next;
    }
}

}  // namespace

Fate PaintRule::fate_of(uint8_t held) const
{
    if (held == group) return Fate::has_group;
    if (locked[held]) return Fate::locked;
    if (locked[group]) return Fate::locked_out;
    return only_unpainted && held != 0 ? Fate::painted : Fate::changes;
}

PaintRule rule_of(const PaintOp& op)
{
    return {.group = op.group, .only_unpainted = op.only_unpainted, .locked = op.locked};
}

std::vector<MaskBrickChange> paint_changes(const Mask& mask, const VoxelSelection& selection, const PaintRule& rule)
{
    static constexpr MaskBrick UNPAINTED{};
    std::vector<MaskBrickChange> changes;
    for (const auto& [index, bits] : selection.bricks()) {
        const MaskBrick* painted = mask.brick(index).get();
        if (!painted && rule.fate_of(0) != Fate::changes) continue;
        MaskBrickChange change{.brick = index, .runs = {}};
        for (size_t row = 0; row < bits.size(); ++row)
            for (uint32_t left = bits[row]; left != 0;) {
                const int first = std::countr_zero(left), length = std::countr_one(left >> first);
                append_runs(change.runs, painted ? *painted : UNPAINTED, 32 * row + size_t(first),
                            32 * row + size_t(first + length), rule);
                // A shift by 32 would be undefined.
                left = first + length == 32 ? 0 : left >> (first + length) << (first + length);
            }
        if (change.runs.empty()) continue;
        change.runs.shrink_to_fit();  // the history keeps it
        changes.push_back(std::move(change));
    }
    return changes;
}

}  // namespace shvr
