// shvr evaluate: measures how well an annotation agrees with the ground truth. Needs no Vulkan device.

#include <iostream>

#include "engine/tasks/evaluate_task.h"
#include "engine/volume/unit.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct EvaluateCommandOptions {
    Common common;
    std::string truth_mask, mask, truth_trace, trace, volume;
    EvaluateTask task{.names = OptionNames::command_line};
};

EvaluateTask task_of(const EvaluateCommandOptions& options)
{
    EvaluateTask task = options.task;
    task.truth_mask = options.truth_mask;
    task.mask = options.mask;
    task.truth_trace = options.truth_trace;
    task.trace = options.trace;
    task.volume = options.volume;
    task.settings = options.common.settings;
    return task;
}

Json number_or_null(const std::optional<double>& value)
{
    return value ? Json(*value) : Json(nullptr);
}

void add_dice(const Dice& dice, Json& result)
{
    result["dice"] = number_or_null(dice.painted);
    for (const auto& [group, value] : dice.by_group) result["dice_by_group"][std::to_string(group)] = value;
    for (const auto& [name, voxels] : {std::pair("truth", &dice.voxels_in_a), {"mask", &dice.voxels_in_b}}) {
        result["voxels_by_group"][name] = Json::object();
        for (const auto& [group, count] : *voxels) result["voxels_by_group"][name][std::to_string(group)] = count;
    }
}

void add_balls(const std::string& what, const BallScores& scores, Json& result)
{
    result[what + "_score"] = number_or_null(scores.mean);
    result[what + "_out"] = {scores.out, scores.total};
}

void add_traces(const TraceComparison& comparison, const std::string& unit, Json& result)
{
    const std::optional<double> micrometres = micrometres_in(unit);
    const auto in_um = [&](const std::optional<double>& length) {
        return length && micrometres ? Json(*length * *micrometres) : Json(nullptr);
    };
    result["segments"] = {comparison.segments_found, comparison.segments_total};
    result["topological_errors"] = comparison.topological_errors();
    result["topological_errors_by_kind"] = {{"wrong", comparison.wrong}, {"doubled", comparison.doubled},
                                            {"gaps", comparison.gaps},   {"breaks", comparison.breaks},
                                            {"spurs", comparison.spurs}, {"superfluous", comparison.superfluous}};
    result["centreline_rms_um"] = in_um(comparison.centreline_rms);
    result["centreline_most_um"] = in_um(comparison.centreline_most);
    result["centreline_rms"] = number_or_null(comparison.centreline_rms);
}

Json to_json(const EvaluateResult& evaluated)
{
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
                   {"unit", evaluated.space ? Json(evaluated.space->unit) : Json(nullptr)},
                   {"complete", evaluated.voxels_not_read == 0},
                   {"voxels_not_read", evaluated.voxels_not_read},
                   {"warnings", evaluated.warnings}};
    if (evaluated.dice) add_dice(*evaluated.dice, result);
    if (evaluated.nodes) add_balls("node", *evaluated.nodes, result);
    if (evaluated.internodes) add_balls("internode", *evaluated.internodes, result);
    if (evaluated.traces) add_traces(*evaluated.traces, evaluated.space.value().unit, result);
    if (evaluated.slack) result["slack"] = *evaluated.slack;
    return result;
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
    const EvaluateTask task = task_of(options);
    check(task);
    LongWork work(options.common.quiet);
    const Json result = to_json(run(task, work));
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
        ->add_option("--truth-group", options->task.truth_groups,
                     "Reads group FROM of the true mask as group TO, as in 255=1; repeatable")
        ->type_name("FROM=TO")
        ->take_all()
        ->allow_extra_args(false);
    command->add_option("--truth-trace", options->truth_trace, "The true trace (.graphml, .txt, .swc, .rsml)");
    command->add_option("--trace", options->trace, "The trace to evaluate");
    command->add_option("--volume", options->volume,
                        "Volume, project or session that all are of: size, spacing and unit where no file states them");
    command
        ->add_option("--slack", options->task.slack,
                     "How far apart two balls may be and still count as touching; the longest side of a voxel")
        ->check(CLI::NonNegativeNumber);
    add_incomplete_option(*command, options->task.allows_incomplete,
                          "Take voxels of masks that cannot be read for unpainted, with a warning, instead of failing");
    add_input_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr evaluate --truth-mask true.mask --mask mine.mask --truth-trace true.graphml "
        "--trace mine.graphml --json");
    command->callback([options] { run_evaluate(*options); });
}

}  // namespace shvr::cli
