#include "engine/annotation/stroke_result.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "engine/base/error.h"

namespace shvr {

namespace {

int64_t sum_of(const StrokeResult::ByGroup& voxels)
{
    return std::accumulate(voxels.begin(), voxels.end(), int64_t{0},
                           [](int64_t sum, const auto& one) { return sum + one.second; });
}

/// Sets the bits `first` ... `last`; returns how many of them were not set before.
int64_t set_bits(VoxelSelection::Bits& bits, size_t first, size_t last)
{
    int64_t added = 0;
    for (size_t at = first; at <= last; ++at) {
        const uint32_t bit = 1u << (at % 32);
        added += (bits[at / 32] & bit) == 0;
        bits[at / 32] |= bit;
    }
    return added;
}

// ---- In words -------------------------------------------------------------------------------------------------------

std::string voxels_in_words(int64_t count)
{
    return sentence(count, count == 1 ? " voxel" : " voxels");
}

std::string named(uint8_t group, const GroupNames& name_of)
{
    const std::string number = sentence("group ", int(group)), name = name_of(group);
    return name.empty() || name == number ? number : sentence(number, " (", name, ")");
}

/// "a", "a and b", "a, b and c"
std::string listed(const std::vector<std::string>& items)
{
    std::string list;
    for (size_t i = 0; i < items.size(); ++i) list += (i == 0 ? "" : i + 1 < items.size() ? ", " : " and ") + items[i];
    return list;
}

/// Lists groups, most voxels first, each as `item(voxels, name)`. Of more than four groups, lists three and a sum.
template <class Item>
std::string listed(const StrokeResult::ByGroup& voxels, const GroupNames& name_of, const Item& item)
{
    constexpr size_t MAX_NAMED = 4;
    std::vector<std::pair<uint8_t, int64_t>> groups(voxels.begin(), voxels.end());
    std::ranges::stable_sort(groups, std::ranges::greater(), &std::pair<uint8_t, int64_t>::second);
    std::vector<std::string> items;
    const size_t shown = groups.size() <= MAX_NAMED ? groups.size() : MAX_NAMED - 1;
    int64_t rest = 0;
    for (size_t i = 0; i < groups.size(); ++i) {
        if (i < shown)
            items.push_back(item(groups[i].second, named(groups[i].first, name_of), i));
        else
            rest += groups[i].second;
    }
    if (rest > 0) items.push_back(sentence(rest, " in ", groups.size() - shown, " other groups"));
    return listed(items);
}

/// Lists the previous groups of the painted voxels, to continue the sentence "Painted N voxels in group G".
std::string taken_in_words(const StrokeResult& result, const GroupNames& name_of)
{
    const int64_t taken = sum_of(result.taken_from);
    if (taken == 0) return {};
    if (taken < result.regrouped)
        return "; " + listed(result.taken_from, name_of, [](int64_t count, const std::string& group, size_t i) {
                   return i > 0 ? sentence(count, " ", group)
                                : sentence(count, count == 1 ? " of them was " : " of them were ", group);
               });
    const std::string from = taken == 1 ? ", taken from " : ", all taken from ";
    if (result.taken_from.size() == 1) return from + named(result.taken_from.begin()->first, name_of);
    return from + "others: " + listed(result.taken_from, name_of, [](int64_t count, const std::string& group, size_t) {
               return sentence(count, " from ", group);
           });
}

std::string erased_in_words(const StrokeResult& result, const GroupNames& name_of)
{
    const std::string erased = "Erased " + voxels_in_words(result.regrouped);
    if (result.taken_from.size() == 1)
        return sentence(erased, " of ", named(result.taken_from.begin()->first, name_of));
    return sentence(erased, ": ",
                    listed(result.taken_from, name_of, [](int64_t count, const std::string& group, size_t) {
                        return sentence(count, " of ", group);
                    }));
}

std::string raised_in_words(const StrokeResult& result, bool is_first)
{
    const PaintOp& stroke = result.stroke;
    const double offset = stroke.erases() || !stroke.density ? 0.0 : stroke.density->offset.value_or(0.0);
    const std::string voxels = " the density of " + voxels_in_words(result.raised);
    if (offset == 0.0) return (is_first ? "Reset" : "reset") + voxels;
    return (is_first ? "Changed" : "changed") + sentence(voxels, " (", offset > 0.0 ? "+" : "", offset, ")");
}

/// Describes the selected voxels that did not change, with the reasons; empty if all of them changed.
std::string kept_in_words(const StrokeResult& result, const GroupNames& name_of)
{
    std::string words;
    if (!result.kept_locked.empty())
        words += sentence("; ",
                          listed(result.kept_locked, name_of,
                                 [](int64_t count, const std::string& group, size_t i) {
                                     return sentence(i > 0 ? sentence(count) : voxels_in_words(count), " of ", group);
                                 }),
                          sum_of(result.kept_locked) == 1 ? " is locked and stayed" : " are locked and stayed");
    if (result.kept_painted > 0)
        words +=
            sentence("; ", voxels_in_words(result.kept_painted),
                     result.kept_painted == 1 ? " is painted already and stayed" : " are painted already and stayed");
    return words;
}

/// Why a brush found no voxel, if it did not.
const char* why_none_found(Brush brush)
{
    switch (brush) {
        case Brush::fill: break;
        case Brush::flood: return "the voxel at the centre of the probe is below the paint threshold";
        case Brush::speckle:
            return "no part at or above the paint threshold lies wholly inside the probe (a larger probe holds larger "
                   "parts)";
    }
    return "no voxel here is at or above the paint threshold";
}

std::string nothing_in_words(const StrokeResult& result, const GroupNames& name_of)
{
    const PaintOp& stroke = result.stroke;
    const char* const nothing = stroke.erases() ? "Nothing was erased" : "Nothing was painted";
    if (stroke.paints_group && stroke.locked[stroke.group])
        return sentence(nothing, ": ", named(stroke.group, name_of), " is locked; unlock it to paint in it");
    if (stroke.erases() && stroke.only_unpainted) return sentence(nothing, ": the brush is held to unpainted voxels");
    const std::string kept = kept_in_words(result, name_of);
    if (!kept.empty()) return nothing + kept;
    return sentence("The stroke changed nothing: ", why_none_found(stroke.brush), ", or all are ",
                    stroke.erases()       ? "unpainted"
                    : stroke.paints_group ? "painted"
                                          : "raised",
                    " already");
}

}  // namespace

int64_t StrokeResult::kept_by_locks() const
{
    return sum_of(kept_locked) + kept_locked_out;
}

// ---- Counting -------------------------------------------------------------------------------------------------------

StrokeTally::StrokeTally(const PaintOp& stroke) : rule_(rule_of(stroke)), result_{.stroke = stroke}
{
    result_.stroke.path.clear();
}

void StrokeTally::add(const Mask& before, const VoxelSelection& selection, std::span<const MaskBrickChange> groups,
                      std::span<const DensityBrickChange> offsets)
{
    for (const MaskBrickChange& change : groups)
        for (const MaskRun& run : change.runs) {
            const int64_t voxels = int64_t{run.last} - run.first + 1;
            result_.regrouped += voxels;
            if (run.before != 0) result_.taken_from[run.before] += voxels;
        }
    // `raised_` counts each voxel once, although a later answer of the device may raise the same voxel further.
    for (const DensityBrickChange& change : offsets)
        for (const DensityRun& run : change.runs)
            result_.raised += set_bits(raised_[change.brick], run.first, run.last);
    if (result_.stroke.paints_group && (rule_.only_unpainted || rule_.locked.any())) add_kept(before, selection);
}

void StrokeTally::add_kept(const Mask& before, const VoxelSelection& selection)
{
    static constexpr MaskBrick UNPAINTED{};
    for (const auto& [index, selected] : selection.bricks()) {
        const MaskBrick* const painted = before.brick(index).get();
        if (!painted && rule_.fate_of(0) != Fate::locked_out) continue;
        const MaskBrick& groups = painted ? *painted : UNPAINTED;
        VoxelSelection::Bits kept{};
        const auto counted = kept_.find(index);
        for (size_t row = 0; row < selected.size(); ++row) {
            uint32_t left = selected[row];
            if (counted != kept_.end()) left &= ~counted->second[row];
            for (; left != 0; left &= left - 1) {
                const auto bit = size_t(std::countr_zero(left));
                const uint8_t group = groups[32 * row + bit];
                const Fate fate = rule_.fate_of(group);
                if (fate == Fate::has_group || fate == Fate::changes) continue;
                kept[row] |= 1u << bit;
                if (fate == Fate::locked) ++result_.kept_locked[group];
                result_.kept_locked_out += fate == Fate::locked_out;
                result_.kept_painted += fate == Fate::painted;
            }
        }
        if (std::ranges::all_of(kept, [](uint32_t word) { return word == 0; })) continue;
        VoxelSelection::Bits& all = counted == kept_.end() ? kept_[index] : counted->second;
        for (size_t row = 0; row < kept.size(); ++row) all[row] |= kept[row];
    }
}

// ---- In words -------------------------------------------------------------------------------------------------------

std::string sentence_of(const StrokeResult& result, const GroupNames& name_of)
{
    if (result.voxels() == 0) return nothing_in_words(result, name_of);
    const PaintOp& stroke = result.stroke;
    std::string words;
    if (result.regrouped > 0)
        words = stroke.erases() ? erased_in_words(result, name_of)
                                : sentence("Painted ", voxels_in_words(result.regrouped), " in ",
                                           named(stroke.group, name_of), taken_in_words(result, name_of));
    if (result.raised > 0) words += (words.empty() ? "" : "; ") + raised_in_words(result, words.empty());
    if (result.regrouped == 0 && stroke.paints_group && stroke.locked[stroke.group])
        return sentence(words, "; ", named(stroke.group, name_of), " is locked, so no voxel was painted");
    return words + kept_in_words(result, name_of);
}

}  // namespace shvr
