#include "engine/tasks/evaluate_task.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <numeric>

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/files/mask_place.h"
#include "engine/annotation/files/mask_source.h"
#include "engine/annotation/trace/trace_file.h"
#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

/// Maps each group number of a mask file to the group number under which its voxels are scored.
struct GroupMap : std::array<uint8_t, 256> {
    GroupMap() { std::iota(begin(), end(), uint8_t{0}); }
};

GroupMap truth_groups_of(const EvaluateTask& task)
{
    GroupMap groups;
    for (const std::string& text : task.truth_groups) {
        const size_t sign = std::min(text.find('='), text.size());
        const std::optional<int64_t> from = whole_of(text.substr(0, sign));
        const std::optional<int64_t> to = whole_of(std::string_view(text).substr(std::min(sign + 1, text.size())));
        const auto is_group = [](const std::optional<int64_t>& group) { return group && *group >= 1 && *group <= 255; };
        if (!is_group(from) || !is_group(to))
            throw UsageError(sentence(option_name(task.names, "truth_group"), " is ", in_quotes(text),
                                      "; expected FROM=TO, two groups of 1 to 255, as in 255=1"));
        groups[size_t(*from)] = uint8_t(*to);
    }
    return groups;
}

std::string in_words(const Size3& size)
{
    return sentence(size.x, " x ", size.y, " x ", size.z);
}

bool is_bare_mask(const fs::path& path)
{
    return path.extension() == ".mask";
}

/// Formats groups as "group 3" or "groups 1, 2 and 255". Truncates long lists.
std::string groups_in_words(const std::map<uint8_t, int64_t>& voxels)
{
    constexpr size_t MAX_NAMED = 8;
    std::string text = voxels.size() == 1 ? "group " : "groups ";
    size_t named = 0;
    for (const auto& [group, count] : voxels) {
        if (named == MAX_NAMED) return sentence(text, " and ", voxels.size() - named, " more");
        const bool is_last = ++named == voxels.size();
        text += sentence(named == 1 ? "" : is_last ? " and " : ", ", int(group));
    }
    return text;
}

/// Refuses a project that has a mask file: its volume holds intensities, but `evaluate` needs groups.
void expect_no_annotated_project(const fs::path& path)
{
    std::error_code ignored;
    if (!fs::exists(path, ignored) || session_file_of(path).empty()) return;
    const fs::path mask = open_unmeasured_session(path).session.mask_path;
    if (!mask.empty() && fs::exists(mask, ignored))
        fail(path.string(), ": is a project or session, whose volume is no mask; expected its mask, ", mask.string(),
             ", or another one");
}

class Evaluation {
public:
    Evaluation(const EvaluateTask& task, ProgressReporter& reporter) : task_(task), reporter_(reporter) {}

    EvaluateResult run()
    {
        result_.space = find_space();
        const GroupMap truth_groups = truth_groups_of(task_);
        if (!result_.space && task_.trace.empty() && is_bare_mask(task_.truth_mask) && is_bare_mask(task_.mask)) {
            take(dice_of_files(truth_groups));
            return std::move(result_);
        }
        const Mask truth = read_mask(task_.truth_mask, truth_groups);
        if (!task_.mask.empty()) compare_masks(truth);
        static_cast<void>(reporter_.begin("comparing traces"));
        if (!task_.trace.empty()) compare_traces(truth, result_.space.value());
        return std::move(result_);
    }

private:
    /// Returns the space of `volume`, or else the space of the first trace or mask that states one.
    std::optional<TraceSpace> find_space() const
    {
        const auto space_at = [&](const fs::path& path) {
            return space_of(open_unmeasured_session(path, task_.settings).source->info());
        };
        if (!task_.volume.empty()) return space_at(task_.volume);
        for (const fs::path& path : {task_.truth_trace, task_.trace}) {
            if (path.empty()) continue;
            if (std::optional<TraceSpace> space = load_trace(path, {}).space) return space;
        }
        for (const fs::path& path : {task_.truth_mask, task_.mask})
            if (!path.empty() && !is_bare_mask(path)) return space_at(path);
        return std::nullopt;
    }

    Mask read_mask(const fs::path& path, const GroupMap& groups = {})
    {
        const Progress progress = reporter_.begin("reading " + path.string());
        const std::optional<TraceSpace>& space = result_.space;
        const auto mask_of = [&](const Size3& size, std::vector<MaskBrickChange> changes) {
            Mask mask(size);
            for (MaskBrickChange& change : changes) {
                for (auto& run : change.runs) run.after = groups[run.after];
                mask.apply(change, Direction::forwards);
            }
            return mask;
        };
        if (!is_bare_mask(path)) {
            expect_no_annotated_project(path);
            const std::unique_ptr<VolumeSource> source = open_volume(path);
            const std::optional<GridPlace> place =
                space ? place_of_mask(path, source->info(), *space) : std::optional<GridPlace>();
            Gaps gaps = gaps_of(task_.allows_incomplete, task_.names);
            const GapSource readable(*source, gaps);
            std::optional<PlacedSource> placed;
            if (place) {
                placed.emplace(readable, *place, *space);
                placed->expect_nothing_outside(path);
                result_.warnings.push_back(
                    sentence(path.string(), ": ", in_words(*place, source->info().size, *space)));
            }
            const VolumeSource& on_grid = placed ? static_cast<const VolumeSource&>(*placed) : readable;
            const Size3 size = on_grid.info().size;
            Mask mask = mask_of(size, mask_changes(ToldSource(on_grid, progress), path.string()));
            result_.voxels_not_read += gaps.voxels();
            if (!gaps.empty())
                result_.warnings.push_back(sentence(path.string(), ": ", gaps.in_words(), " and count as unpainted"));
            return mask;
        }
        if (!space)
            throw UsageError(sentence(path.string(), ": does not state the size of its volume; expected ",
                                      option_name(task_.names, "volume"), ", or masks in another format"));
        return mask_of(space->size, load_mask(path, space->size));
    }

    /// Computes the Dice scores of two bare masks: files without a header, so that their shapes may be unknown.
    Dice dice_of_files(const GroupMap& groups_of_truth)
    {
        const Progress progress = reporter_.begin("comparing masks");
        const std::string paths[2] = {task_.truth_mask.string(), task_.mask.string()};
        std::ifstream files[2];
        std::uintmax_t sizes[2];
        for (const int index : {0, 1}) {
            const std::string& path = paths[index];
            if (!fs::is_regular_file(path)) fail(path, ": is not a regular file; expected a mask");
            files[index].open(path, std::ios::binary);
            if (!files[index]) fail(path, ": cannot be opened; expected a mask");
            sizes[index] = fs::file_size(path);
        }
        if (sizes[0] != sizes[1])
            fail(paths[1], ": holds ", sizes[1], " bytes; expected ", sizes[0], ", the size of ", paths[0]);
        DiceCounter counter;
        std::vector<uint8_t> bytes[2];
        for (std::uintmax_t done = 0; done < sizes[0]; done += bytes[0].size()) {
            for (const int index : {0, 1}) {
                bytes[index].resize(size_t(std::min<std::uintmax_t>(sizes[0] - done, 1 << 20)));
                char* const to = reinterpret_cast<char*>(bytes[index].data());
                if (!files[index].read(to, std::streamsize(bytes[index].size())))
                    fail(paths[index], ": was shortened while it was being read; expected ", sizes[0], " bytes");
            }
            for (uint8_t& group : bytes[0]) group = groups_of_truth[group];
            counter.add(bytes[0], bytes[1]);
            tell(progress, double(done) / double(sizes[0]));
        }
        return counter.result();
    }

    void compare_masks(const Mask& truth)
    {
        const Mask mask = read_mask(task_.mask);
        static_cast<void>(reporter_.begin("comparing masks"));
        if (mask.size() != truth.size())
            fail(task_.mask.string(), ": size is ", in_words(mask.size()), " voxels; expected ", in_words(truth.size()),
                 ", the size of ", task_.truth_mask.string());
        take(dice_of(truth, mask));
    }

    /// Warns if both masks have groups, but none in common.
    void take(const Dice& dice)
    {
        result_.dice = dice;
        const std::map<uint8_t, int64_t>&truth = dice.voxels_in_a, &mask = dice.voxels_in_b;
        const auto is_in_mask = [&](const auto& entry) { return mask.contains(entry.first); };
        if (truth.empty() || mask.empty() || std::ranges::any_of(truth, is_in_mask)) return;
        result_.warnings.push_back(sentence(
            task_.truth_mask.string(), ": holds ", groups_in_words(truth), ", but ", task_.mask.string(), " holds ",
            groups_in_words(mask),
            ", so that dice_by_group is 0 throughout; if they mean the same, read the truth with ",
            option_name(task_.names, "truth_group"), " ", int(truth.begin()->first), "=", int(mask.begin()->first)));
    }

    TraceGraph read_trace(const fs::path& path, const TraceSpace& space)
    {
        TraceFile file = load_trace(path, space);
        for (std::string& warning : file.warnings) result_.warnings.push_back(std::move(warning));
        return std::move(file.trace);
    }

    void compare_traces(const Mask& truth, const TraceSpace& space)
    {
        const TraceGraph trace = read_trace(task_.trace, space);
        result_.nodes = score_nodes(trace, truth, space.spacing);
        result_.internodes = score_internodes(trace, truth, space.spacing);
        if (task_.truth_trace.empty()) return;
        result_.slack = task_.slack.value_or(std::max({space.spacing.x, space.spacing.y, space.spacing.z}));
        result_.traces = compare(trace, read_trace(task_.truth_trace, space), *result_.slack);
    }

    const EvaluateTask& task_;
    ProgressReporter& reporter_;
    EvaluateResult result_;
};

}  // namespace

void fields(Fields& f, EvaluateTask& task)
{
    f.path("truth_mask", task.truth_mask,
           {.meaning = "the true mask: .mask, or a volume of uint8",
            .allowed = PATH_OR_ADDRESS,
            .standard = "required",
            .is_required = true});
    f.path("mask", task.mask, {.meaning = "the mask to evaluate", .allowed = PATH_OR_ADDRESS, .standard = "none"});
    texts_field(f, "truth_group", task.truth_groups,
                {.meaning = "reads group FROM of the true mask as group TO",
                 .allowed = "texts, each FROM=TO",
                 .standard = "none"});
    f.path("truth_trace", task.truth_trace,
           {.meaning = "the true trace: .graphml, .txt, .swc, .rsml", .standard = "none"});
    f.path("trace", task.trace, {.meaning = "the trace to evaluate", .standard = "none"});
    f.path("volume", task.volume,
           {.meaning = "that all are of: size, spacing and unit where no file states them",
            .allowed = PATH_OR_ADDRESS,
            .standard = "none"});
    f.number("slack", task.slack, {0.0, 1e15},
             {.meaning = "how far apart two balls may be and still count as touching",
              .unit = "physical units",
              .standard = "the longest side of a voxel"});
    incomplete_field(f, task.allows_incomplete, "voxels of masks that cannot be read count as unpainted");
    texts_field(f, "set", task.settings,
                {.meaning = "keys of a session, for `volume`", .allowed = "texts", .standard = "none"});
}

void check(const EvaluateTask& task)
{
    const auto name = [&](const char* key) { return option_name(task.names, key); };
    if (task.truth_mask.empty()) throw UsageError("no " + name("truth_mask") + " is given; expected a mask");
    if (task.mask.empty() && task.trace.empty())
        throw UsageError(
            sentence("neither ", name("mask"), " nor ", name("trace"), " is given; expected at least one of them"));
    if (!task.truth_trace.empty() && task.trace.empty())
        throw UsageError(sentence(name("truth_trace"), " is given without ", name("trace"), "; expected both"));
    if (task.slack && !(*task.slack >= 0.0))
        throw UsageError(sentence(name("slack"), " is ", *task.slack, "; expected a distance of 0 or more"));
    static_cast<void>(truth_groups_of(task));
}

EvaluateResult run(const EvaluateTask& task, ProgressReporter& reporter)
{
    check(task);
    return Evaluation(task, reporter).run();
}

}  // namespace shvr
