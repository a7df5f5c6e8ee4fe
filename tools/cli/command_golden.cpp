// shvr golden: regression pictures, of this repository and of users' own sessions (tools/golden/USING.md).

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iostream>

#include "engine/pages/html.h"
#include "tools/cli/array/split_job.h"
#include "tools/cli/cli.h"
#include "tools/golden/calibrate.h"
#include "tools/golden/run.h"

namespace shvr::cli {

namespace {

namespace fs = std::filesystem;

struct GoldenCommandOptions {
    Common common;
    std::string pattern = "*";
    std::string folder = "golden";
    std::string output = "golden-results";
    std::string reason;
    std::string table;  ///< output of calibrate; empty: none
    std::string task;   ///< as add_task_option has it
    bool only_failed = false, keeps_light = false;
};

golden::StudioOptions studio_options(const Common& common)
{
    golden::set_environment(common.device);
    const char* validation = std::getenv("SHVR_VALIDATION");
    return {.device = common.device, .validation = validation && *validation == '1'};
}

Json outcome_json(const golden::Outcome& outcome)
{
    Json json{{"run", outcome.results.size()},
              {"failed", outcome.failed},
              {"report", outcome.report.string()},
              {"goldens", Json::array()}};
    for (const golden::Result& result : outcome.results) json["goldens"].push_back(golden::json_of(result));
    return json;
}

void print_lines(const std::string& text)
{
    clear_progress();
    std::cout << text << std::flush;
    if (!std::cout) fail("standard output: cannot be written");
}

std::string lines_of(const golden::Outcome& outcome)
{
    std::string text;
    for (const golden::Result& result : outcome.results) {
        text += sentence(spelled(result.status), "  ", result.golden.name);
        if (!result.reason.empty()) text += ": " + result.reason;
        text += "\n";
        if (golden::can_be_blessed(result.status))
            text += "  if it is meant: " + golden::bless_command(result.golden) + "\n";
    }
    return text + outcome.report.string() + "\n";
}

/// Returns every N-th golden, of those that N tasks draw.
std::vector<golden::Golden> goldens_of(const TaskChoice& task, const std::vector<golden::Golden>& goldens)
{
    std::vector<golden::Golden> chosen;
    for (size_t i = size_t(task.index); i < goldens.size(); i += size_t(task.of)) chosen.push_back(goldens[i]);
    return chosen;
}

void run_goldens(const GoldenCommandOptions& options)
{
    check_output_folder(options.output);
    const std::vector<golden::Golden> goldens = golden::goldens_in(options.folder, options.pattern);
    SplitJob job(options.task, options.output, options.common);
    job.begin({options.folder});
    if (job.is_task() && job.is_done()) return job.report();
    LongWork work(options.common.quiet);
    const Progress progress = work.begin(job.gathers() ? "joining results" : "drawing goldens");
    const auto show = [&](const golden::Golden&, double fraction) {
        work.stop_if_asked();
        tell(progress, fraction);
    };
    if (job.is_task()) {
        golden::run_part(goldens_of(job.choice(), goldens), options.output, job.piece(), studio_options(options.common),
                         show, options.keeps_light);
        clear_progress();
        return job.report();
    }
    const golden::Outcome outcome =
        job.gathers()
            ? golden::join_parts(goldens, options.output, job.all_pieces())
            : golden::run_all(goldens, options.output, studio_options(options.common), show, options.keeps_light);
    clear_progress();
    if (options.common.json)
        print(outcome_json(outcome));
    else
        print_lines(lines_of(outcome));
    if (!outcome.failed.empty())
        throw GateError(sentence(outcome.failed.size(), " of ", outcome.results.size(), " goldens failed, the first: ",
                                 outcome.failed.front(), "; see ", outcome.report.string()));
}

/// Returns the goldens with matching names; with `only_failed`, only those that failed in the last run.
std::vector<golden::Golden> chosen(const GoldenCommandOptions& options)
{
    std::vector<golden::Golden> goldens = golden::goldens_in(options.folder, options.pattern);
    if (!options.only_failed) return goldens;
    const std::vector<std::string> failed = golden::read_run(options.output, options.pattern).failed;
    std::erase_if(goldens,
                  [&](const golden::Golden& one) { return std::ranges::find(failed, one.name) == failed.end(); });
    if (goldens.empty()) fail(options.output, ": nothing failed in the last run; there is nothing to bless");
    return goldens;
}

void bless(const GoldenCommandOptions& options)
{
    if (options.reason.empty()) throw UsageError("--reason is missing; expected why the pictures change");
    check_output_folder(options.folder);
    LongWork work(options.common.quiet);
    const Progress progress = work.begin("blessing goldens");
    Json rows = Json::array();
    std::string text;
    const std::vector<golden::Golden> goldens = chosen(options);
    for (const golden::Golden& one : goldens) {
        work.stop_if_asked();
        tell(progress, double(rows.size()) / double(goldens.size()));
        const golden::Blessed blessed = golden::bless(one, options.reason, studio_options(options.common));
        rows.push_back({{"name", blessed.name},
                        {"old", blessed.old_hash},
                        {"new", blessed.new_hash},
                        {"max_abs", blessed.change ? Json(blessed.change->max_abs) : Json(nullptr)}});
        text += sentence(blessed.name, ": ", blessed.old_hash, " -> ", blessed.new_hash);
        if (blessed.change) text += sentence(", largest change ", blessed.change->max_abs, " of 255 levels");
        text += "\n";
    }
    clear_progress();
    if (options.common.json)
        print({{"blessed", rows}});
    else
        print_lines(text + "Look at each new picture before it is committed, with its side-car.\n");
}

/// Runs `shvr golden run` in a separate process, since drivers read their environment only when they are loaded.
void run_variant(const GoldenCommandOptions& options, const golden::Variant& variant, const fs::path& output)
{
    std::vector<std::string> arguments{"shvr", "golden",        "run",     options.pattern, "--folder", options.folder,
                                       "-o",   output.string(), "--quiet", "--json",        "--light"};
    if (!options.common.device.empty()) arguments.insert(arguments.end(), {"--device", options.common.device});
    // Mesa's shader cache does not distinguish vector widths: with a shared one, all variants would run the code that
    // was compiled first.
    const std::string cache = fs::absolute(output / "shader-cache").string();
    fs::create_directories(cache);
    std::vector<std::pair<std::string, std::string>> changed = variant.environment;
    changed.insert(changed.end(), {{"MESA_SHADER_CACHE_DIR", cache}, {"XDG_CACHE_HOME", cache}});
    std::vector<std::string> environment;
    for (char** entry = environ; *entry; ++entry) {
        const std::string text = *entry, name = text.substr(0, text.find('='));
        const auto is_it = [&](const auto& pair) { return pair.first == name; };
        if (std::ranges::none_of(changed, is_it)) environment.push_back(text);
    }
    for (const auto& [name, value] : changed) environment.push_back(name + "=" + value);
    const auto pointers = [](std::vector<std::string>& texts) {
        std::vector<char*> all;
        for (std::string& text : texts) all.push_back(text.data());
        all.push_back(nullptr);
        return all;
    };
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int error = posix_spawn(&child, "/proc/self/exe", &actions, nullptr, pointers(arguments).data(),
                                  pointers(environment).data());
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    if (error == 0) ::waitpid(child, &status, 0);
    // Exit status 3 means that pictures differ, which is the expected result of this measurement.
    if (error != 0 || !WIFEXITED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != 3))
        fail("goldens could not be drawn as ", variant.name, "; expected exit status 0 or 3 of shvr golden run");
}

Json spread_json(const golden::Moved& moved)
{
    return {{"max_abs", moved.pixels.max_abs},
            {"rmse", moved.pixels.rmse},
            {"alpha_rmse", moved.pixels.alpha_rmse},
            {"mean_error", moved.pixels.mean_error},
            {"fraction_over_1", moved.pixels.fraction_over_1},
            {"light", moved.light}};
}

/// Returns the command line that repeats the calibration, for the page.
std::string calibrate_command(const GoldenCommandOptions& options)
{
    return sentence("shvr golden calibrate", options.pattern == "*" ? "" : " '" + options.pattern + "'", " --folder ",
                    options.folder, " --table ", options.table);
}

void calibrate(const GoldenCommandOptions& options)
{
    check_output_folder(options.output);
    if (!options.table.empty()) check_output("--table", options.table, {".md"});
    const std::vector<golden::Golden> goldens = golden::goldens_in(options.folder, options.pattern);
    LongWork work(options.common.quiet);
    const Progress progress = work.begin("drawing goldens in every way");
    size_t done = 0;
    const std::vector<golden::Spread> spreads =
        golden::calibrate(goldens, options.output, [&](const golden::Variant& variant, const fs::path& output) {
            work.stop_if_asked();
            tell(progress, double(done++) / double(golden::variants().size()));
            run_variant(options, variant, output);
        });
    Json rows = Json::array(), failed = Json::array();
    std::string text;
    for (const golden::Spread& spread : spreads) {
        Json by_variant = Json::object();
        for (const auto& [name, moved] : spread.by_variant) by_variant[name] = spread_json(moved);
        const std::string verdict = !spread.holds           ? "too strict: the driver alone moves it by more than half"
                                    : spread.could_be_exact ? "holds; no pixel moves"
                                                            : "holds";
        rows.push_back({{"name", spread.golden.name},
                        {"class", spelled(spread.golden.strictness)},
                        {"holds", spread.holds},
                        {"could_be_exact", spread.could_be_exact},
                        {"most", spread_json(spread.most)},
                        {"variants", by_variant}});
        if (!spread.holds) failed.push_back(spread.golden.name);
        text += sentence(spread.golden.name, " (", spelled(spread.golden.strictness), "): ", verdict, "; at most ",
                         spread.most.pixels.max_abs, " levels, ", 100.0 * spread.most.pixels.fraction_over_1,
                         " % of pixels by more than 1, ", spread.most.light, " in linear light\n");
    }
    if (!options.table.empty())
        report::write_text(options.table, golden::table_of(spreads, calibrate_command(options)));
    clear_progress();
    if (options.common.json)
        print({{"goldens", rows}, {"failed", failed}});
    else
        print_lines(text);
    if (!failed.empty())
        throw GateError(sentence(
            failed.size(), " goldens have a class that is too strict, the first: ", failed.front().get<std::string>()));
}

void report_again(const GoldenCommandOptions& options)
{
    check_output_folder(options.output);
    LongWork work(options.common.quiet);
    static_cast<void>(work.begin("writing the report"));
    const golden::Outcome outcome = golden::read_run(options.output, options.pattern);
    golden::write_reports(outcome, options.output);
    clear_progress();
    if (options.common.json)
        print(outcome_json(outcome));
    else
        print_lines(lines_of(outcome));
}

CLI::App* add_part(CLI::App& command, const std::shared_ptr<GoldenCommandOptions>& options, const char* name,
                   const char* does, const char* example, void (*run)(const GoldenCommandOptions&))
{
    CLI::App* part = command.add_subcommand(name, does);
    part->add_option("PATTERN", options->pattern, "Names of goldens, as in 'tubes_*'")->capture_default_str();
    part->add_option("--folder", options->folder, "Folder of goldens: NAME.json, NAME.png, NAME.blessed.json")
        ->capture_default_str();
    part->add_option("-o,--output", options->output, "Folder for pictures, results.json, junit.xml and report.html")
        ->capture_default_str();
    part->add_option("--device", options->common.device,
                     "Vulkan device: part of its name, or its index; without it $SHVR_DEVICE, else lavapipe");
    add_output_options(*part, options->common);
    part->footer(sentence("Example:\n  ", example));
    part->callback([options, run] { run(*options); });
    return part;
}

}  // namespace

void add_golden(CLI::App& program)
{
    auto options = std::make_shared<GoldenCommandOptions>();
    CLI::App* command =
        program.add_subcommand("golden", "Regression pictures: draws sessions and compares them with what was blessed");
    command->require_subcommand(1);
    CLI::App* draw = add_part(*command, options, "run", "Draws them and compares; exit 3 where one fails",
                              "shvr golden run 'tubes_*' --folder golden -o golden-results", run_goldens);
    draw->add_flag("--light", options->keeps_light, "NAME.actual.pfm, too: the picture in linear light, 32-bit floats");
    add_task_option(*draw, options->task);
    CLI::App* accept =
        add_part(*command, options, "bless", "Accepts what is drawn now as correct; on lavapipe alone, never in CI",
                 "shvr golden bless overview --reason \"The light comes from the left\"", bless);
    accept->add_option("--reason", options->reason, "Why the pictures change; kept in the side-cars");
    accept->add_flag("--failed", options->only_failed, "Those alone that failed in the last run, as --output has it");
    add_part(
        *command, options, "calibrate",
        "How far vector width, threads, instruction set and poisoned memory move them; exit 3 where a class is too "
        "strict",
        "shvr golden calibrate --folder golden --table golden/CALIBRATION.md", calibrate)
        ->add_option("--table", options->table, "Table to write (.md), to be kept beside the goldens");
    add_part(*command, options, "report", "Writes report.html and junit.xml of the last run again",
             "shvr golden report -o golden-results", report_again);
    command->footer(
        "A golden is a file NAME.json with \"why\", \"session\" (an object, or the path of a session) and perhaps\n"
        "\"class\" (exact, tight, edge) and \"script\" (lines as shvr annotate reads them).\n\n"
        "Example:\n  shvr golden bless overview --reason \"first picture\"\n  shvr golden run");
}

}  // namespace shvr::cli
