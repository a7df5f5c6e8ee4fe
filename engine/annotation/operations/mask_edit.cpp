#include "engine/annotation/operations/mask_edit.h"

#include <algorithm>

#include "engine/annotation/sets/brick_bits.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {

namespace {

constexpr MaskBrick UNPAINTED{};
/// The journal takes records of 1 GiB.
constexpr uint64_t MAX_BYTES = uint64_t{1} << 30;

std::string named(uint8_t group, const GroupNames& name_of)
{
    if (group == 0) return "unpainted";
    const std::string number = sentence("group ", int(group)), name = name_of ? name_of(group) : std::string();
    return name.empty() || name == number ? number : sentence(number, " (", name, ')');
}

std::string joined(const std::vector<std::string>& items)
{
    std::string list;
    for (size_t i = 0; i < items.size(); ++i) list += (i == 0 ? "" : i + 1 < items.size() ? ", " : " and ") + items[i];
    return list;
}

/// Describes the most frequent changes from one group to another, each with its number of voxels.
std::string moved_in_words(const OperationResult& result, const ResultWords& words)
{
    constexpr size_t MOST = 4;
    const char* const would = words.is_preview ? " would be" : "";
    std::vector<std::pair<std::pair<uint8_t, uint8_t>, int64_t>> moved(result.moved.begin(), result.moved.end());
    std::ranges::stable_sort(moved, std::ranges::greater(), [](const auto& each) { return each.second; });
    std::vector<std::string> items;
    int64_t rest = 0;
    for (const auto& [groups, voxels] : moved) {
        const std::string many = counted(voxels, "voxel");
        const std::string before = named(groups.first, words.name_of), after = named(groups.second, words.name_of);
        if (items.size() == MOST)
            rest += voxels;
        else if (groups.second == 0)
            items.push_back(sentence(many, " of ", before, would, " erased"));
        else if (groups.first == 0)
            items.push_back(sentence(many, would, " painted in ", after));
        else
            items.push_back(sentence(many, " of ", before, would, " moved to ", after));
    }
    if (rest > 0) items.push_back(std::to_string(rest) + " more");
    return joined(items);
}

std::string kept_in_words(const OperationResult& result, const ResultWords& words)
{
    std::string text;
    for (const auto& [group, voxels] : result.kept_locked)
        text += sentence("; ", named(group, words.name_of), " is locked, so ", counted(voxels, "voxel"),
                         words.is_preview ? " would stay" : " stayed");
    if (result.kept_by_limits == 0) return text;
    const bool is_one = result.kept_by_limits == 1;
    return text + sentence("; the limits ", words.is_preview ? "would keep " : "kept ",
                           counted(result.kept_by_limits, "voxel"), " as ", is_one ? "it " : "they ",
                           !words.is_preview ? (is_one ? "was" : "were")
                           : is_one          ? "is"
                                             : "are");
}

}  // namespace

std::string sentence_of(const OperationResult& result, const std::string& title, const ResultWords& words)
{
    const std::string note = result.note.empty() ? "" : "; " + result.note, kept = kept_in_words(result, words);
    if (!result.trace_changes.empty())
        return sentence(title, words.is_preview ? " (preview): " : ": ", result.note, kept);
    const char* const nothing = words.is_preview ? "nothing would change" : "nothing changed";
    return sentence(title, ": ", result.voxels == 0 ? nothing : moved_in_words(result, words), note, kept);
}

MaskEdit::MaskEdit(const OperationInput& input, const OperationLimits& limits)
    : input_(input), limits_(limits), plane_(plane_in_voxels(limits, input.volume.spacing))
{
    SHVR_CHECK(input.mask.size() == input.volume.size);
}

const VolumeSource& MaskEdit::source() const
{
    if (!input_.source) fail("the operation needs intensities, and there are none here");
    return *input_.source;
}

void MaskEdit::check_memory(uint64_t bytes) const
{
    const auto mib = [](uint64_t size) { return (size + (uint64_t{1} << 20) - 1) >> 20; };
    if (input_.memory == 0 || bytes <= input_.memory) return;
    fail("the operation takes ", mib(bytes), " MiB of memory; expected at most ", mib(input_.memory),
         " MiB, the budget of the host: use a larger --budget-host, or a smaller group");
}

const MaskBrick& MaskEdit::read(int64_t brick)
{
    ++result_.bricks_read;
    const MaskBrick* const held = mask().brick(brick).get();
    return held ? *held : UNPAINTED;
}

bool MaskEdit::may_change(int64_t brick) const
{
    const VoxelBox box = mask().box_of(brick);
    if (limits_.box && !meet(box, *limits_.box)) return false;
    Size3 farthest_behind(0);
    for (int axis = 0; axis < 3; ++axis)
        farthest_behind[axis] = plane_[axis] > 0.0 ? box.lower[axis] : box.upper[axis] - 1;
    return is_behind_plane(farthest_behind);
}

bool MaskEdit::is_within(int64_t brick, size_t index)
{
    const VoxelBox box = mask().box_of(brick);
    const Size3 extent = box.size();
    if (intensities_of_ != brick) {
        const VoxelType type = input_.volume.type;
        std::vector<std::byte> voxels(size_t(extent.x * extent.y * extent.z) * bytes_of(type));
        source().read(box, voxels);
        intensities_.resize(size_t(extent.x * extent.y * extent.z));
        load_voxels(type, voxels.data(), intensities_);
        intensities_of_ = brick;
        ++result_.bricks_of_intensities;
    }
    const double value = intensities_[size_t(index_of(position_of(int64_t(index), Size3(BRICK_SIDE)), extent))];
    return value >= limits_.within->x && value <= limits_.within->y;
}

bool MaskEdit::changes(int64_t brick, const MaskRun& run)
{
    const auto& [first, last, held, wanted] = run;
    if (input_.locked[held] || input_.locked[wanted]) {
        result_.kept_locked[input_.locked[held] ? held : wanted] += last - first + 1;
        return false;
    }
    if ((limits_.only_unpainted && held != 0) || (limits_.inside && *limits_.inside != held) ||
        (limits_.within && !is_within(brick, first))) {
        result_.kept_by_limits += last - first + 1;
        return false;
    }
    return true;
}

/// Appends the changes of the voxels from `first` to before `end`, which lie in one row.
void MaskEdit::want_row(MaskBrickChange& change, const MaskBrick& held, const MaskBrick& wanted, size_t first,
                        size_t end)
{
    if (std::equal(held.begin() + first, held.begin() + end, wanted.begin() + first)) return;
    for (size_t next = first; next < end;) {
        first = next++;
        if (held[first] == wanted[first]) continue;
        // Intensities decide on single voxels.
        if (!limits_.within) next = std::min(end_of_run(held, first, end), end_of_run(wanted, first, end));
        const MaskRun run{uint16_t(first), uint16_t(next - 1), held[first], wanted[first]};
        if (!changes(change.brick, run)) continue;
        append_run(change.runs, run.first, run.last, run.before, run.after);
        result_.moved[{run.before, run.after}] += int64_t(next - first);
        result_.voxels += int64_t(next - first);
    }
}

void MaskEdit::want(int64_t brick, const MaskBrick& wanted)
{
    const MaskBrick* const painted = mask().brick(brick).get();
    const MaskBrick& held = painted ? *painted : UNPAINTED;
    if (!may_change(brick) || held == wanted) return;
    VoxelBox box = mask().box_of(brick);
    const Size3 corner = box.lower;
    if (limits_.box) box = {glm::max(box.lower, limits_.box->lower), glm::min(box.upper, limits_.box->upper)};
    MaskBrickChange change{.brick = brick, .runs = {}};
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y) {
            const size_t row = size_t(index_of(Size3(0, y - corner.y, z - corner.z), Size3(BRICK_SIDE)));
            int64_t first = box.lower.x, end = box.upper.x;
            while (first < end && !is_behind_plane({first, y, z})) ++first;
            while (first < end && !is_behind_plane({end - 1, y, z})) --end;
            want_row(change, held, wanted, row + size_t(first - corner.x), row + size_t(end - corner.x));
        }
    if (change.runs.empty()) return;
    change.runs.shrink_to_fit();  // the history keeps it
    bytes_ += change.runs.size() * sizeof(MaskRun);
    if (bytes_ > MAX_BYTES)
        fail("the operation changes more than one step can hold (", MAX_BYTES,
             " bytes); expected less: limit it to a box");
    ++result_.bricks_written;
    result_.changes.push_back(std::move(change));
}

OperationResult MaskEdit::take()
{
    std::ranges::sort(result_.changes, {}, &MaskBrickChange::brick);
    return std::move(result_);
}

}  // namespace shvr
