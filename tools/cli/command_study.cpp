// shvr study: the thesis's study, repeated by simulated annotators. Needs no device.

#include <algorithm>
#include <limits>

#include "engine/base/text.h"
#include "engine/study/study.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct StudyCommandOptions {
    Common common;
    std::string folder, conditions, size = "standard", part;
    std::optional<uint32_t> seeds;
};

/// "2/8"
std::pair<int64_t, int64_t> parse_part(const std::string& text)
{
    if (text.empty()) return {0, 1};
    const size_t slash = std::min(text.find('/'), text.size());
    const std::optional<int64_t> part = whole_of(text.substr(0, slash));
    const std::optional<int64_t> of = whole_of(std::string_view(text).substr(std::min(slash + 1, text.size())));
    if (!part || !of || *of < 1 || *part < 0 || *part >= *of)
        throw UsageError(sentence("--task is ", in_quotes(text), "; expected I/N, with I from 0 to N - 1, as in 2/8"));
    return {*part, *of};
}

StudySize size_named(const std::string& text)
{
    for (const Spelling<StudySize>& each : STUDY_SIZES)
        if (each.name == text) return each.value;
    return StudySize::standard;
}

double mean_of(const std::vector<StudyRow>& rows, const StudyCondition& condition, Outcome outcome)
{
    double sum = 0.0;
    int count = 0;
    for (const StudyRow& row : rows)
        if (row.condition == condition && row[outcome] == row[outcome]) sum += row[outcome], ++count;
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

/// A line for each condition, with the mean of its main outcome.
void say_means(const std::vector<StudyRow>& rows, const Common& common)
{
    std::vector<StudyCondition> said;
    for (const StudyRow& row : rows) {
        const StudyCondition& c = row.condition;
        if (std::ranges::find(said, c) != said.end()) continue;
        said.push_back(c);
        const Outcome main = c.task == StudyTask::paint ? Outcome::dice_partial : Outcome::node_score;
        say(common, sentence(spelled(c.task), ", touch ", spelled(c.touch), ", law ", spelled(c.law), ", probe ",
                             c.probe_radii, " radii, noise ", c.noise, " %: ",
                             c.task == StudyTask::paint ? "Dice score " : "node score ", mean_of(rows, c, main)));
    }
}

void run_study_command(const StudyCommandOptions& options)
{
    StudyChoice choice{.size = size_named(options.size), .seeds = options.seeds, .conditions = {}};
    const auto [part, of] = parse_part(options.part);
    if (!options.conditions.empty()) choice.conditions = read_study_conditions(options.conditions);
    const StudyPlan plan = plan_study(choice);
    LongWork work(options.common.quiet);
    const StudyRun run{.folder = options.folder,
                       .threads = options.common.threads,
                       .part = part,
                       .of = of,
                       .progress = work.begin("annotating phantoms for " + options.folder)};
    const StudyResults results = run_study(plan, run);
    clear_progress();
    const std::string csv = (std::filesystem::path(options.folder) / "rows.csv").string();
    if (options.common.json) {
        print({{"report", nullptr},
               {"csv", csv},
               {"rows", results.rows.size()},
               {"made", results.made_here},
               {"missing", results.missing}});
        return;
    }
    say_means(results.rows, options.common);
    say(options.common, sentence(results.rows.size(), " rows by simulated annotators; made ", results.made_here,
                                 ", missing ", results.missing, "; ", csv));
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
    command->add_option("--task", options->part, "Makes part I of N only, from 0 on; without it, all that is missing")
        ->type_name("I/N");
    command->add_option("--threads", options->common.threads, "Worker threads; 0: one per core")
        ->check(CLI::Range(0, 1024));
    add_output_options(*command, options->common);
    command->footer(
        "Small takes seconds, standard about an hour of two cores, full several hours: split it with --task, then run "
        "it once without.\nExample:\n  shvr study --size small -o study");
    command->callback([options] { run_study_command(*options); });
}

}  // namespace shvr::cli
