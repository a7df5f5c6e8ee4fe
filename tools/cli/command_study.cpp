// shvr study: the thesis's study, repeated by simulated annotators. Needs no device.

#include <filesystem>
#include <span>

#include "engine/base/atomic_file.h"
#include "engine/base/text.h"
#include "engine/study/report/plots.h"
#include "engine/study/report/report.h"
#include "engine/study/statistics.h"
#include "engine/study/study.h"
#include "tools/cli/array/split_job.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct StudyCommandOptions {
    Common common;
    std::string folder, conditions, size = "standard", part;
    std::optional<uint32_t> seeds;
    std::vector<uint32_t> annotators;
    bool keeps_annotations = false;
};

StudySize size_named(const std::string& text)
{
    for (const Spelling<StudySize>& each : STUDY_SIZES)
        if (each.name == text) return each.value;
    return StudySize::standard;
}

/// Prints a line for each condition, with the mean of its main outcome.
void say_means(const std::vector<StudyRow>& rows, const Common& common)
{
    for (const StudyCondition& condition : conditions_of(rows)) {
        const OutcomeColumn& column = outcome_columns()[size_t(main_outcome(condition.task))];
        const Summary summary = summary_of(values_of(rows, condition, column.outcome));
        say(common, sentence(spelled(condition.task), ", ", words_of(condition), ": ", column.name, ' ', summary.mean,
                             column.unit == "1" ? "" : sentence(' ', column.unit), " of ", summary.count));
    }
}

StudyReport report_of(const StudyCommandOptions& options, const StudyPlan& plan, const StudyResults& results)
{
    StudyReport report{
        .command = "shvr study --size " + options.size + " -o FOLDER",
        .version = version_in_words(),
        .phantom = sentence("The phantom of kind section (shvr phantom section): a part of a flower head in ",
                            plan.side, " voxels a side, another one for each seed; its veins have radii of ",
                            short_digits(0.013 * double(plan.side)), " to ", short_digits(0.021 * double(plan.side)),
                            " voxels."),
        .annotators =
            "Ten annotators, models of a hand, an eye, a plan and a clock, calibrated against "
            "table 6.1 of the thesis before conditions were compared "
            "(engine/study/CALIBRATION.md). They are models, not people.",
        .centre = study_centre(StudyTask::trace),
        .rows = results.rows,
        .hand = {},
        .variations = {},
        .repeats = results.repeats,
        .baselines = {},
        .no_baselines = {}};
    if (options.seeds) report.command += sentence(" --seeds ", *options.seeds);
    if (!options.conditions.empty()) report.command += " --conditions FILE";
    for (const uint32_t annotator : plan.annotators)
        report.command += sentence(annotator == plan.annotators.front() ? " --annotators " : ",", annotator);
    const HandTraits traits;
    for (const HandTrait& trait : hand_traits())
        report.hand.push_back({.name = std::string(trait.name),
                               .value = digits_of(traits.*trait.value),
                               .unit = std::string(trait.unit),
                               .source = std::string(trait.source)});
    for (const StudyVariation& each : results.variations)
        report.variations.push_back(
            {.parameter = std::string(hand_traits()[each.trait].name), .factor = each.factor, .rows = each.rows});
    const std::filesystem::path baselines = std::filesystem::path(options.folder) / "baselines.csv";
    if (std::error_code unknown; std::filesystem::exists(baselines, unknown))
        report.baselines = read_baselines(baselines);
    else
        report.no_baselines = "The folder holds no baselines.csv; tools/study/baselines.py writes it.";
    return report;
}

void write_text(const std::filesystem::path& path, const std::string& text)
{
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

void run_study_command(const StudyCommandOptions& options)
{
    StudyChoice choice{
        .size = size_named(options.size), .seeds = options.seeds, .conditions = {}, .annotators = options.annotators};
    SplitJob job(options.part, options.folder, options.common);
    if (!options.conditions.empty()) choice.conditions = read_study_conditions(options.conditions);
    const StudyPlan plan = plan_study(choice);
    job.begin({options.conditions});
    LongWork work(options.common.quiet);
    const StudyRun run{.folder = options.folder,
                       .threads = options.common.threads,
                       .part = job.is_task() ? job.choice().index : 0,
                       .of = job.is_task() ? job.of() : 1,
                       .keeps_annotations = options.keeps_annotations,
                       .progress = work.begin("annotating phantoms for " + options.folder)};
    const StudyResults results = run_study(plan, run);
    clear_progress();
    if (job.is_task()) write_text(job.piece(), sentence(results.made_here, "\n"));
    const std::filesystem::path folder = options.folder;
    const std::string csv = (folder / "rows.csv").string(), report = (folder / "report.html").string();
    const bool is_whole = results.missing == 0;
    if (is_whole) {
        if (!results.repeats.empty()) write_text(folder / "repeats.csv", csv_of(results.repeats));
        write_text(report, page_of(report_of(options, plan, results)));
    }
    if (options.common.json) {
        Json told{{"report", is_whole ? Json(report) : Json(nullptr)},
                  {"csv", csv},
                  {"rows", results.rows.size()},
                  {"made", results.made_here},
                  {"missing", results.missing}};
        if (job.is_task()) told.update({{"task", job.choice().in_words()}, {"pieces", job.of()}});
        print(told);
        return;
    }
    say_means(results.rows, options.common);
    say(options.common, sentence(results.rows.size(), " rows by simulated annotators; made ", results.made_here,
                                 ", missing ", results.missing, "; ", is_whole ? report : csv));
}

}  // namespace

void add_study(CLI::App& program)
{
    auto options = std::make_shared<StudyCommandOptions>();
    CLI::App* command =
        program.add_subcommand("study", "Repeats the thesis's study of assistance with simulated annotators");
    command->add_option("-o,--output", options->folder, "Folder of the results; a study that is there is continued")
        ->required();
    command->add_option("--size", options->size, "How many annotations, and of which phantoms")
        ->check(CLI::IsMember({"small", "standard", "full"}))
        ->capture_default_str();
    command->add_option("--seeds", options->seeds, "Phantoms for each condition, instead of the size's number")
        ->check(CLI::Range(1, 10000));
    command->add_option("--conditions", options->conditions,
                        "CSV file with the columns task, touch, law, probe_radii, noise, instead of the size's own");
    command
        ->add_option("--annotators", options->annotators,
                     "Numbers, 1 to 10: each of them annotates each phantom; without it, one for each phantom in turn")
        ->delimiter(',')
        ->type_name("N,N...")
        ->check(CLI::Range(1U, STUDY_ANNOTATORS));
    command->add_flag("--keep-annotations", options->keeps_annotations,
                      "Writes each trace and mask into the folder annotations, where those that are missing are made "
                      "again");
    add_task_option(*command, options->part);
    command->add_option("--threads", options->common.threads, "Worker threads; 0: one per core")
        ->check(CLI::Range(0, 1024));
    add_output_options(*command, options->common);
    command->footer(
        "Small takes seconds, standard half an hour of two cores, full 4 core-hours: split it with --task (up to 90 "
        "tasks), then join it with shvr gather.\nExample:\n  shvr study --size small -o study");
    command->callback([options] { run_study_command(*options); });
}

}  // namespace shvr::cli
