// shvr evaluate: how well an annotation agrees with the truth. Needs no device.

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <numeric>

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/files/mask_source.h"
#include "engine/annotation/measures/measures.h"
#include "engine/annotation/measures/trace_score.h"
#include "engine/base/text.h"
#include "engine/volume/unit.h"
#include "engine/volume/voxel_walk.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

/// Which group of a file is read as which.
struct GroupMap : std::array<uint8_t, 256> {
    GroupMap() { std::iota(begin(), end(), uint8_t{0}); }
};

struct EvaluateCommandOptions {
    Common common;
    std::string truth_mask, mask, truth_trace, trace, volume;
    std::vector<std::string> truth_groups;
    std::optional<double> slack;
};

GroupMap truth_groups_of(const EvaluateCommandOptions& options)
{
    GroupMap groups;
    for (const std::string& text : options.truth_groups) {
        const size_t sign = std::min(text.find('='), text.size());
        const std::optional<int64_t> from = whole_of(text.substr(0, sign));
        const std::optional<int64_t> to = whole_of(std::string_view(text).substr(std::min(sign + 1, text.size())));
        const auto is_group = [](const std::optional<int64_t>& group) { return group && *group >= 1 && *group <= 255; };
        if (!is_group(from) || !is_group(to))
            throw UsageError(sentence("--truth-group is ", in_quotes(text),
                                      "; expected FROM=TO, two groups of 1 to 255, as in 255=1"));
        groups[size_t(*from)] = uint8_t(*to);
    }
    return groups;
}

std::string in_words(const Size3& size)
{
    return sentence(size.x, " x ", size.y, " x ", size.z);
}

bool is_bare_mask(const std::filesystem::path& path)
{
    return path.extension() == ".mask";
}

Mask read_mask(const std::string& path, const std::optional<TraceSpace>& space, LongWork& work,
               const GroupMap& groups = {})
{
    const Progress progress = work.begin("reading " + path);
    const auto mask_of = [&](const Size3& size, std::vector<MaskBrickChange> changes) {
        Mask mask(size);
        for (MaskBrickChange& change : changes) {
            for (auto& run : change.runs) run.after = groups[run.after];
            mask.apply(change, Direction::forwards);
        }
        return mask;
    };
    if (!is_bare_mask(path)) {
        const std::unique_ptr<VolumeSource> source = open_volume(path);
        const Size3 size = source->info().size;
        if (space && size != space->size)
            fail(path, ": size is ", in_words(size), " voxels; expected ", in_words(space->size));
        const std::string elsewhere = space ? why_elsewhere(space_of(source->info()), *space) : std::string();
        if (!elsewhere.empty()) fail(path, ": is a mask of a volume with ", elsewhere, ", where the others lie");
        return mask_of(size, mask_changes(ToldSource(*source, progress), path));
    }
    if (!space)
        throw UsageError(
            sentence(path, ": does not state the size of its volume; expected --volume, or masks in another format"));
    return mask_of(space->size, load_mask(path, space->size));
}

/// The space of --volume; else of the first trace or mask that states one.
std::optional<TraceSpace> find_space(const EvaluateCommandOptions& options)
{
    if (!options.volume.empty())
        return space_of(open_unmeasured_session(options.volume, options.common.settings).source->info());
    for (const std::string& path : {options.truth_trace, options.trace}) {
        if (path.empty()) continue;
        if (std::optional<TraceSpace> space = load_trace(path, {}).space) return space;
    }
    for (const std::string& path : {options.truth_mask, options.mask})
        if (!path.empty() && !is_bare_mask(path))
            return space_of(open_unmeasured_session(path, options.common.settings).source->info());
    return std::nullopt;
}

Json number_or_null(const std::optional<double>& value)
{
    return value ? Json(*value) : Json(nullptr);
}

/// Dice of two bare masks, whose shape may be unknown.
Dice dice_of_files(const std::string& a, const std::string& b, const GroupMap& groups_of_a, const Progress& progress)
{
    std::ifstream files[2];
    std::uintmax_t sizes[2];
    for (const auto& [index, path] : {std::pair(0, &a), {1, &b}}) {
        if (!std::filesystem::is_regular_file(*path)) fail(*path, ": is not a regular file; expected a mask");
        files[index].open(*path, std::ios::binary);
        if (!files[index]) fail(*path, ": cannot be opened; expected a mask");
        sizes[index] = std::filesystem::file_size(*path);
    }
    if (sizes[0] != sizes[1]) fail(b, ": holds ", sizes[1], " bytes; expected ", sizes[0], ", the size of ", a);
    DiceCounter counter;
    std::vector<uint8_t> bytes[2];
    for (std::uintmax_t done = 0; done < sizes[0]; done += bytes[0].size()) {
        for (const int index : {0, 1}) {
            bytes[index].resize(size_t(std::min<std::uintmax_t>(sizes[0] - done, 1 << 20)));
            if (!files[index].read(reinterpret_cast<char*>(bytes[index].data()), std::streamsize(bytes[index].size())))
                fail(index == 0 ? a : b, ": was shortened while it was being read; expected ", sizes[0], " bytes");
        }
        for (uint8_t& group : bytes[0]) group = groups_of_a[group];
        counter.add(bytes[0], bytes[1]);
        tell(progress, double(done) / double(sizes[0]));
    }
    return counter.result();
}

/// "group 3", "groups 1, 2 and 255"; many are cut short.
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

void add_dice(const EvaluateCommandOptions& options, const Dice& dice, Json& result)
{
    result["dice"] = number_or_null(dice.painted);
    for (const auto& [group, value] : dice.by_group) result["dice_by_group"][std::to_string(group)] = value;
    for (const auto& [name, voxels] : {std::pair("truth", &dice.voxels_in_a), {"mask", &dice.voxels_in_b}}) {
        result["voxels_by_group"][name] = Json::object();
        for (const auto& [group, count] : *voxels) result["voxels_by_group"][name][std::to_string(group)] = count;
    }
    const std::map<uint8_t, int64_t>&truth = dice.voxels_in_a, &mask = dice.voxels_in_b;
    const auto is_in_mask = [&](const auto& entry) { return mask.contains(entry.first); };
    if (truth.empty() || mask.empty() || std::ranges::any_of(truth, is_in_mask)) return;
    result["warnings"].push_back(
        sentence(options.truth_mask, ": holds ", groups_in_words(truth), ", but ", options.mask, " holds ",
                 groups_in_words(mask),
                 ", so that dice_by_group is 0 throughout; if they mean the same, read the truth with --truth-group ",
                 int(truth.begin()->first), "=", int(mask.begin()->first)));
}

void add_mask_scores(const EvaluateCommandOptions& options, const Mask& truth, const std::optional<TraceSpace>& space,
                     Json& result, LongWork& work)
{
    if (options.mask.empty()) return;
    const Mask mask = read_mask(options.mask, space, work);
    static_cast<void>(work.begin("comparing masks"));
    if (mask.size() != truth.size())
        fail(options.mask, ": size is ", in_words(mask.size()), " voxels; expected ", in_words(truth.size()),
             ", the size of ", options.truth_mask);
    add_dice(options, dice_of(truth, mask), result);
}

void add_trace_scores(const EvaluateCommandOptions& options, const Mask& truth, const TraceSpace& space, Json& result)
{
    const TraceGraph trace = load_trace(options.trace, space).trace;
    const BallScores nodes = score_nodes(trace, truth, space.spacing);
    const BallScores internodes = score_internodes(trace, truth, space.spacing);
    result["node_score"] = number_or_null(nodes.mean);
    result["node_out"] = {nodes.out, nodes.total};
    result["internode_score"] = number_or_null(internodes.mean);
    result["internode_out"] = {internodes.out, internodes.total};
    if (options.truth_trace.empty()) return;
    const double slack = options.slack.value_or(std::max({space.spacing.x, space.spacing.y, space.spacing.z}));
    const TraceComparison comparison = compare(trace, load_trace(options.truth_trace, space).trace, slack);
    const std::optional<double> micrometres = micrometres_in(space.unit);
    const auto in_um = [&](const std::optional<double>& length) {
        return length && micrometres ? Json(*length * *micrometres) : Json(nullptr);
    };
    result["segments"] = {comparison.segments_found, comparison.segments_total};
    result["topological_errors"] = comparison.topological_errors();
    result["topological_errors_by_kind"] = {
        {"wrong", comparison.wrong}, {"doubled", comparison.doubled}, {"gaps", comparison.gaps}};
    result["centreline_rms_um"] = in_um(comparison.centreline_rms);
    result["centreline_most_um"] = in_um(comparison.centreline_most);
    result["centreline_rms"] = number_or_null(comparison.centreline_rms);
    result["slack"] = slack;
}

void print_text(const Json& result)
{
    for (const auto& [key, value] : result.items())
        if (key != "warnings") std::cout << key << ": " << value.dump() << '\n';
    std::cout.flush();
    if (!std::cout) fail("standard output: cannot be written");
}

void run_evaluate(const EvaluateCommandOptions& options)
{
    if (options.mask.empty() && options.trace.empty())
        throw UsageError("neither --mask nor --trace is given; expected at least one of them");
    if (!options.truth_trace.empty() && options.trace.empty())
        throw UsageError("--truth-trace is given without --trace; expected both");
    LongWork work(options.common.quiet);
    const std::optional<TraceSpace> space = find_space(options);
    Json result = {{"dice", nullptr},
                   {"dice_by_group", Json::object()},
                   {"voxels_by_group", nullptr},
                   {"node_score", nullptr},
                   {"node_out", nullptr},
                   {"internode_score", nullptr},
                   {"internode_out", nullptr},
                   {"segments", nullptr},
                   {"topological_errors", nullptr},
                   {"centreline_rms_um", nullptr},
                   {"unit", space ? Json(space->unit) : Json(nullptr)},
                   {"warnings", Json::array()}};
    const GroupMap truth_groups = truth_groups_of(options);
    if (!space && options.trace.empty() && is_bare_mask(options.truth_mask) && is_bare_mask(options.mask)) {
        add_dice(options, dice_of_files(options.truth_mask, options.mask, truth_groups, work.begin("comparing masks")),
                 result);
    } else {
        const Mask truth = read_mask(options.truth_mask, space, work, truth_groups);
        add_mask_scores(options, truth, space, result, work);
        static_cast<void>(work.begin("comparing traces"));
        if (!options.trace.empty()) add_trace_scores(options, truth, space.value(), result);
    }
    clear_progress();
    warn(result["warnings"].get<std::vector<std::string>>(), options.common);
    if (options.common.json)
        print(result);
    else
        print_text(result);
}

}  // namespace

void add_evaluate(CLI::App& program)
{
    auto options = std::make_shared<EvaluateCommandOptions>();
    CLI::App* command = program.add_subcommand("evaluate", "Measures how well an annotation agrees with the truth");
    command->add_option("--truth-mask", options->truth_mask, "The true mask (.mask, or a volume of uint8)")->required();
    command->add_option("--mask", options->mask, "The mask to evaluate");
    command
        ->add_option("--truth-group", options->truth_groups,
                     "Reads group FROM of the true mask as group TO, as in 255=1; repeatable")
        ->type_name("FROM=TO")
        ->take_all()
        ->allow_extra_args(false);
    command->add_option("--truth-trace", options->truth_trace, "The true trace (.graphml, .txt, .swc, .rsml)");
    command->add_option("--trace", options->trace, "The trace to evaluate");
    command->add_option("--volume", options->volume,
                        "Volume, project or session that all are of: size, spacing and unit where no file states them");
    command
        ->add_option("--slack", options->slack,
                     "How far apart two balls may be and still count as touching; the longest side of a voxel")
        ->check(CLI::NonNegativeNumber);
    add_input_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr evaluate --truth-mask true.mask --mask mine.mask --truth-trace true.graphml "
        "--trace mine.graphml --json");
    command->callback([options] { run_evaluate(*options); });
}

}  // namespace shvr::cli
