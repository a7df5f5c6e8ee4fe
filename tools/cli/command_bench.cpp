// shvr bench: measures time and error of drawing with various settings, relative to the reference renderer.

#include <iostream>
#include <sstream>

#include "engine/base/file.h"
#include "engine/base/machine/machine.h"
#include "engine/base/text.h"
#include "engine/pages/html.h"
#include "tools/bench/page.h"
#include "tools/bench/part.h"
#include "tools/cli/array/split_job.h"
#include "tools/cli/cli.h"
#include "tools/cli/haptics_report.h"

namespace shvr::cli {

namespace {

struct ErrorBenchOptions {
    Common common;
    std::vector<std::string> scenes;
    std::string output;
    std::string task;  ///< as add_task_option has it
    std::vector<std::string> sweeps;
    std::vector<std::string> compared;  ///< none, or two files
    std::vector<std::string> mappers = {"fixed"};
    std::string peer, examples;  ///< empty: the default paths in the source tree of this program
    int64_t side = 0;            ///< 0: 32 if quick, otherwise 64
    std::vector<uint32_t> size;  ///< size of pictures; empty: 48 x 36 with --quick, otherwise 120 x 90
    bool quick = false, ignores_time = false;
    int rounds = 0;  ///< 0: 3 if quick, otherwise 7
    int mixed = 0;
};

void print_out(const std::string& text)
{
    clear_progress();
    std::cout << text << std::flush;
    if (!std::cout) fail("standard output: cannot be written");
}

int threads_of(const ErrorBenchOptions& options)
{
    return options.common.threads > 0 ? options.common.threads : processors_allowed();
}

Json pareto_row(const bench::SceneResult& scene, const bench::Measured& run)
{
    return {{"scene", scene.name},
            {"run", run.name},
            {"median_ms", run.time.median_ms},
            {"rmse", run.error.rmse},
            {"flip_mean", run.error.flip_mean}};
}

constexpr const char* SWEEPS[] = {"blur", "labelling", "proxy"};
constexpr int64_t MAX_SWEEP_BYTES = 1 << 20;

/// Returns a path in the source tree in which the program was built; empty if that file does not exist.
std::filesystem::path in_tree(const std::filesystem::path& path)
{
    std::error_code unknown;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
    const std::filesystem::path found = std::filesystem::weakly_canonical(program / "../.." / path, unknown);
    return std::filesystem::exists(found, unknown) ? found : std::filesystem::path();
}

/// Returns the present commit of the source tree. The program may be older, if files have changed since it was built.
std::string commit_of_tree()
{
    const std::filesystem::path folder = in_tree(".git");
    const auto line_of = [](const std::filesystem::path& path) {
        return is_file(path) ? std::string(trimmed(read_text(path, MAX_SWEEP_BYTES))) : std::string();
    };
    if (folder.empty()) return {};
    const std::string head = line_of(folder / "HEAD");
    constexpr std::string_view REFERENCE = "ref: ";
    if (!head.starts_with(REFERENCE)) return head;
    const std::string name = head.substr(REFERENCE.size());
    if (const std::string commit = line_of(folder / name); !commit.empty()) return commit;
    std::istringstream packed(line_of(folder / "packed-refs"));
    for (std::string line; std::getline(packed, line);)
        if (line.ends_with(" " + name)) return line.substr(0, line.find(' '));
    return {};
}

bench::Sweep proxy_sweep(const std::filesystem::path& output, LongWork& work)
{
    const std::filesystem::path csv = output / "sweep-proxy.csv", svg = output / "sweep-proxy.svg";
    sweep_proxy(csv.string(), svg.string(), work);
    return {.name = "proxy",
            .what =
                "The probe's proxy by exact integration and by points, over sizes of the ball: time against error, "
                "as shvr haptics bench --sweep measures it.",
            .error = "RMS error, % of the radius",
            .rows = {},
            .plot = {},
            .svg = read_text(svg, MAX_SWEEP_BYTES),
            .table = read_text(csv, MAX_SWEEP_BYTES)};
}

/// Whether the task of a job, or this process if there are no tasks, measures the scene or sweep with this number.
bool is_own(const SplitJob& job, size_t number)
{
    return !job.is_task() || int64_t(number) % job.of() == job.choice().index;
}

std::vector<bench::Sweep> chosen_sweeps(const ErrorBenchOptions& options, const SplitJob& job, LongWork& work)
{
    std::vector<std::string> names = options.sweeps;
    if (names.empty() && options.scenes.empty()) names.assign(std::begin(SWEEPS), std::end(SWEEPS));
    const bench::SweepOptions asked{
        .quick = options.quick, .threads = threads_of(options), .scratch = options.output, .poll = [&] {
            work.stop_if_asked();
        }};
    std::vector<bench::Sweep> sweeps;
    for (size_t number = 0; number < names.size(); ++number) {
        const std::string& name = names[number];
        if (!is_own(job, number)) continue;
        const Progress progress = work.begin(name);
        tell(progress, 0.0);
        sweeps.push_back(name == "blur"        ? bench::sweep_blur(asked)
                         : name == "labelling" ? bench::sweep_labelling(asked)
                                               : proxy_sweep(options.output, work));
    }
    return sweeps;
}

bench::ChosenScenes scenes_of(const ErrorBenchOptions& options, const glm::uvec2& pixels)
{
    if (options.scenes.empty() && !options.sweeps.empty()) return {};
    return bench::chosen_scenes(
        {.names = options.scenes,
         .side = options.side > 0 ? options.side
                 : options.quick  ? 32
                                  : 64,
         .pixels = pixels,
         .examples = options.examples.empty() ? in_tree("build/example") : std::filesystem::path(options.examples)});
}

bench::PeerOptions peer_of(const ErrorBenchOptions& options)
{
    bench::PeerOptions peer{.program = {}, .mappers = options.mappers, .threads = threads_of(options)};
    if (options.peer != "none")
        peer.program =
            options.peer.empty() ? in_tree("tools/peers/vtk_raycast.py") : std::filesystem::path(options.peer);
    return peer;
}

/// Measures all scenes and sweeps, or those of the task.
bench::Part measure(const ErrorBenchOptions& options, const SplitJob& job, const bench::ChosenScenes& chosen,
                    const glm::uvec2& pixels, LongWork& work)
{
    const auto& [scenes, left_out] = chosen;
    bench::Part part{.results = bench::who_measures(options.common.device), .pictures = {}, .sweeps = {}};
    bench::Results& results = part.results;
    results.rounds = options.rounds > 0 ? options.rounds : options.quick ? 3 : 7;
    results.version = SHVR_VERSION;
    results.commit = commit_of_tree();
    results.width = pixels.x;
    results.height = pixels.y;
    results.left_out = left_out;
    for (size_t number = 0; number < scenes.size(); ++number) {
        const bench::Scene& scene = scenes[number];
        if (!is_own(job, number)) continue;
        const Progress progress = work.begin(scene.name);
        bench::MeasuredScene measured = bench::measure_scene(scene, {.device = options.common.device,
                                                                     .quick = options.quick,
                                                                     .mixed = options.mixed,
                                                                     .rounds = results.rounds,
                                                                     .threads = threads_of(options),
                                                                     .peer = peer_of(options),
                                                                     .kept = options.output,
                                                                     .tell = [&](const std::string&, double share) {
                                                                         work.stop_if_asked();
                                                                         tell(progress, share);
                                                                     }});
        results.scenes.push_back(std::move(measured.result));
        part.pictures.push_back(std::move(measured.pictures));
    }
    part.sweeps = chosen_sweeps(options, job, work);
    return part;
}

bench::Part join(const SplitJob& job)
{
    std::vector<bench::Part> parts;
    for (const std::filesystem::path& piece : job.all_pieces()) parts.push_back(bench::read_part(piece));
    return bench::joined(std::move(parts));
}

void run_scenes(const ErrorBenchOptions& options)
{
    if (options.output.empty())
        throw UsageError("--output is missing; expected the folder for bench.json and the report");
    check_output_folder(options.output);
    SplitJob job(options.task, options.output, options.common);
    job.begin({});
    if (job.is_task() && job.is_done()) return job.report();
    golden::set_environment(options.common.device);
    const glm::uvec2 pixels = !options.size.empty() ? glm::uvec2(options.size.at(0), options.size.at(1))
                              : options.quick       ? glm::uvec2(48, 36)
                                                    : glm::uvec2(120, 90);
    const bench::ChosenScenes chosen = scenes_of(options, pixels);
    for (const std::string& sentence : chosen.left_out) say(options.common, sentence);
    const std::filesystem::path output = options.output;
    report::make_folder(output);

    LongWork work(options.common.quiet);
    const bench::Part part = job.gathers() ? join(job) : measure(options, job, chosen, pixels, work);
    if (job.is_task()) {
        bench::write_part(part, job.piece());
        clear_progress();
        return job.report();
    }
    const std::vector<std::string> written = bench::write_files(part.results, part.pictures, part.sweeps, output);
    Json pareto = Json::array();
    std::string text;
    for (const bench::SceneResult& scene : part.results.scenes) {
        text += scene.name + "\n";
        if (const std::optional<std::string> busy = bench::why_times_tell_little(scene)) text += "  " + *busy + "\n";
        for (const std::string& note : scene.notes) text += "  " + note + "\n";
        for (const bench::Measured& run : scene.runs) {
            if (run.on_front) pareto.push_back(pareto_row(scene, run));
            text += sentence(run.on_front ? "  * " : "    ", run.name, ": ", run.time.median_ms, " ms, RMSE ",
                             run.error.rmse, ", FLIP ", run.error.flip_mean, "\n");
        }
    }
    if (options.common.json)
        print({{"bench", (output / "bench.json").string()},
               {"pareto", pareto},
               {"left_out", part.results.left_out},
               {"written", written}});
    else
        print_out(text + "* on the front: no other run is better in both\n" + (output / "report.html").string() + "\n");
}

void compare_files(const ErrorBenchOptions& options)
{
    const bench::Comparison comparison = bench::compare(
        bench::read_results(options.compared[0]), bench::read_results(options.compared[1]), !options.ignores_time);
    const std::vector<bench::Change>& changes = comparison.changes;
    Json rows = Json::array();
    size_t regressions = 0;
    for (const bench::Change& change : changes) {
        regressions += change.is_regression ? 1 : 0;
        rows.push_back({{"scene", change.scene},
                        {"run", change.run},
                        {"what", change.what},
                        {"a", change.a},
                        {"b", change.b},
                        {"noise", change.noise},
                        {"machine", change.machine},
                        {"regression", change.is_regression}});
    }
    if (options.common.json)
        print({{"changes", rows}, {"regressions", regressions}, {"beside", comparison.beside}});
    else
        print_out(bench::text_of(comparison));
    if (regressions > 0)
        throw GateError(sentence(regressions, " of ", changes.size(), " changes are regressions, the first: ",
                                 changes.front().scene, ", ", changes.front().run, ": ", changes.front().what));
}

/// Adds the options that select the pictures and how they are drawn.
void add_picture_options(CLI::App& command, ErrorBenchOptions& options)
{
    command
        .add_option(
            "--scenes", options.scenes,
            "Scenes, with commas between: tubes, noisy-surface, tissue, fog, peaks, uint16, anisotropic, paged, "
            "painted, occluded, surfaces; tubes-matt, noisy-surface-matt, tissue-matt, which VTK draws the same; "
            "stent, cranium, stent-matt, cranium-matt (tools/fetch_example); or paths of sessions; unless given, all "
            "that exist")
        ->delimiter(',');
    command
        .add_option("--sweeps", options.sweeps,
                    "blur, labelling, proxy: speed against error beside pictures; without it and --scenes all")
        ->delimiter(',')
        ->check(CLI::IsMember(std::vector<std::string>(std::begin(SWEEPS), std::end(SWEEPS))));
    command.add_option("--side", options.side, "Voxels along each side of our own scenes; 64, or 32 where quick")
        ->check(CLI::Range(16, 512));
    command.add_option("--size", options.size, "Pixels, width,height; 120,90, or 48,36 where quick")
        ->delimiter(',')
        ->expected(2)
        ->check(CLI::Range(8, 4096));
    command.add_option(
        "--peer", options.peer,
        "Program that draws with VTK, where it draws the same: tools/peers/vtk_raycast.py, unless given; "
        "none: SHVR alone");
    command.add_option("--mappers", options.mappers, "VTK's: fixed (its better one on processors), gpu (OpenGL)")
        ->delimiter(',')
        ->check(CLI::IsMember({"fixed", "gpu"}));
    command.add_option("--examples", options.examples,
                       "Folder of the scans; that of tools/fetch_example, unless given");
    command.add_flag("--quick", options.quick, "Small volumes, few runs: seconds a scene");
    command
        .add_option("--mixed", options.mixed,
                    "Number of additional runs, each with its own step, resolution, opacity limit, pre-integration "
                    "and sampling")
        ->check(CLI::Range(0, 1024));
    command.add_option("--rounds", options.rounds, "Timed pictures of each run, alternating between runs")
        ->check(CLI::Range(1, 1000));
}

}  // namespace

void add_bench(CLI::App& program)
{
    auto options = std::make_shared<ErrorBenchOptions>();
    CLI::App* command =
        program.add_subcommand("bench", "Speed against error: each way of drawing against the reference renderer");
    add_picture_options(*command, *options);
    command->add_option("-o,--output", options->output,
                        "Folder for bench.json, bench.csv, equal_*.csv, pareto*.svg and .png, insets.png, sweep-*, "
                        "report.html, and the references");
    add_task_option(*command, options->task);
    command->add_option("--compare", options->compared, "Two bench.json instead: exit 3 where the second is worse")
        ->expected(2);
    command->add_flag("--ignore-time", options->ignores_time, "With --compare: errors and exact work alone");
    command->add_option("--device", options->common.device,
                        "Vulkan device: part of its name, or its index; without it $SHVR_DEVICE, else lavapipe");
    command->add_option("--threads", options->common.threads, "Threads of the reference renderer; 0: one per core")
        ->check(CLI::Range(0, 1024));
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr bench --scenes tubes,tissue --quick -o bench\n"
        "  shvr bench --scenes noisy-surface-matt --side 128 --size 256,192 -o beside-vtk\n"
        "  shvr bench --compare before/bench.json after/bench.json");
    command->callback([options] {
        if (options->compared.empty())
            run_scenes(*options);
        else
            compare_files(*options);
    });
}

}  // namespace shvr::cli
