// shvr evaluate: how well an annotation agrees with the truth. Needs no device.

#include <algorithm>
#include <fstream>
#include <iostream>

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/files/mask_source.h"
#include "engine/annotation/measures/measures.h"
#include "engine/annotation/measures/trace_score.h"
#include "engine/volume/unit.h"
#include "engine/volume/voxel_walk.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct EvaluateCommandOptions {
    Common common;
    std::string truth_mask, mask, truth_trace, trace, volume;
    std::optional<double> slack;
};

bool is_bare_mask(const std::filesystem::path& path)
{
    return path.extension() == ".mask";
}

Mask read_mask(const std::string& path, const std::optional<TraceSpace>& space, LongWork& work)
{
    const Progress progress = work.begin("reading " + path);
    if (!is_bare_mask(path)) {
        const std::unique_ptr<VolumeSource> source = open_volume(path);
        if (space && source->info().size != space->size)
            fail(path, ": has ", source->info().size.x, " x ", source->info().size.y, " x ", source->info().size.z,
                 " voxels; expected ", space->size.x, " x ", space->size.y, " x ", space->size.z);
        Mask mask(source->info().size);
        for (const MaskBrickChange& change : mask_changes(ToldSource(*source, progress), path))
            mask.apply(change, Direction::forwards);
        return mask;
    }
    if (!space)
        throw UsageError(
            sentence(path, " does not say how large its volume is; expected --volume, or masks in another form"));
    Mask mask(space->size);
    for (const MaskBrickChange& change : load_mask(path, space->size)) mask.apply(change, Direction::forwards);
    return mask;
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
        if (!path.empty() && !is_bare_mask(path)) return space_of(open_volume(path)->info());
    return std::nullopt;
}

Json number_or_null(const std::optional<double>& value)
{
    return value ? Json(*value) : Json(nullptr);
}

/// Dice of two bare masks, whose shape may be unknown.
Dice dice_of_files(const std::string& a, const std::string& b, const Progress& progress)
{
    std::ifstream files[2];
    std::uintmax_t sizes[2];
    for (const auto& [index, path] : {std::pair(0, &a), {1, &b}}) {
        if (!std::filesystem::is_regular_file(*path)) fail(*path, ": is no regular file; expected a mask");
        files[index].open(*path, std::ios::binary);
        if (!files[index]) fail(*path, ": cannot be opened; expected a mask");
        sizes[index] = std::filesystem::file_size(*path);
    }
    if (sizes[0] != sizes[1]) fail(b, ": holds ", sizes[1], " bytes; expected ", sizes[0], ", as many as ", a);
    DiceCounter counter;
    std::vector<uint8_t> bytes[2];
    for (std::uintmax_t done = 0; done < sizes[0]; done += bytes[0].size()) {
        for (const int index : {0, 1}) {
            bytes[index].resize(size_t(std::min<std::uintmax_t>(sizes[0] - done, 1 << 20)));
            if (!files[index].read(reinterpret_cast<char*>(bytes[index].data()), std::streamsize(bytes[index].size())))
                fail(index == 0 ? a : b, ": became shorter while it was read; expected its size to stay");
        }
        counter.add(bytes[0], bytes[1]);
        tell(progress, double(done) / double(sizes[0]));
    }
    return counter.result();
}

void add_dice(const Dice& dice, Json& result)
{
    result["dice"] = number_or_null(dice.painted);
    for (const auto& [group, value] : dice.by_group) result["dice_by_group"][std::to_string(group)] = value;
}

void add_mask_scores(const EvaluateCommandOptions& options, const Mask& truth, const std::optional<TraceSpace>& space,
                     Json& result, LongWork& work)
{
    if (options.mask.empty()) return;
    const Mask mask = read_mask(options.mask, space, work);
    static_cast<void>(work.begin("comparing masks"));
    if (mask.size() != truth.size())
        fail(options.mask, ": has another size than ", options.truth_mask, "; expected the same");
    add_dice(dice_of(truth, mask), result);
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
    for (const auto& [key, value] : result.items()) std::cout << key << ": " << value.dump() << '\n';
    std::cout.flush();
    if (!std::cout) fail("standard output: cannot be written");
}

void run_evaluate(const EvaluateCommandOptions& options)
{
    if (options.mask.empty() && options.trace.empty())
        throw UsageError("neither --mask nor --trace is given; expected what is to be evaluated");
    if (!options.truth_trace.empty() && options.trace.empty())
        throw UsageError("--truth-trace is given without --trace; expected both");
    LongWork work(options.common.quiet);
    const std::optional<TraceSpace> space = find_space(options);
    Json result = {{"dice", nullptr},
                   {"dice_by_group", Json::object()},
                   {"node_score", nullptr},
                   {"node_out", nullptr},
                   {"internode_score", nullptr},
                   {"internode_out", nullptr},
                   {"segments", nullptr},
                   {"topological_errors", nullptr},
                   {"centreline_rms_um", nullptr},
                   {"unit", space ? Json(space->unit) : Json(nullptr)}};
    if (!space && options.trace.empty() && is_bare_mask(options.truth_mask) && is_bare_mask(options.mask)) {
        add_dice(dice_of_files(options.truth_mask, options.mask, work.begin("comparing masks")), result);
    } else {
        const Mask truth = read_mask(options.truth_mask, space, work);
        add_mask_scores(options, truth, space, result, work);
        static_cast<void>(work.begin("comparing traces"));
        if (!options.trace.empty()) add_trace_scores(options, truth, space.value(), result);
    }
    clear_progress();
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
