// shvr bench: time against error, each way of drawing measured against the reference renderer.

#include <iostream>
#include <thread>

#include "tools/bench/page.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct ErrorBenchOptions {
    Common common;
    std::vector<std::string> scenes;
    std::string output;
    std::vector<std::string> compared;  ///< none, or two files
    bool quick = false, ignores_time = false;
    int rounds = 0;  ///< 0: 3 where quick, otherwise 7
};

void print_out(const std::string& text)
{
    clear_progress();
    std::cout << text << std::flush;
    if (!std::cout) fail("standard output: cannot be written");
}

Json pareto_row(const bench::SceneResult& scene, const bench::Measured& run)
{
    return {{"scene", scene.name},
            {"run", run.name},
            {"median_ms", run.time.median_ms},
            {"rmse", run.error.rmse},
            {"flip_mean", run.error.flip_mean}};
}

void run_scenes(const ErrorBenchOptions& options)
{
    if (options.output.empty())
        throw UsageError("--output is missing; expected the folder for bench.json and the report");
    golden::set_environment(options.common.device);
    const int64_t side = options.quick ? 32 : 64;
    const glm::uvec2 pixels = options.quick ? glm::uvec2(48, 36) : glm::uvec2(120, 90);
    const std::vector<bench::Scene> scenes = bench::chosen_scenes(options.scenes, side, pixels);
    const std::filesystem::path output = options.output;
    std::filesystem::create_directories(output);

    LongWork work(options.common.quiet);
    bench::Results results = bench::who_measures(options.common.device);
    results.rounds = options.rounds > 0 ? options.rounds : options.quick ? 3 : 7;
    results.width = pixels.x;
    results.height = pixels.y;
    std::vector<bench::Pictures> pictures;
    for (const bench::Scene& scene : scenes) {
        const Progress progress = work.begin(scene.name);
        bench::MeasuredScene measured = bench::measure_scene(
            scene,
            {.device = options.common.device,
             .quick = options.quick,
             .rounds = results.rounds,
             .threads = options.common.threads > 0 ? options.common.threads : int(std::thread::hardware_concurrency()),
             .kept = output,
             .tell = [&](const std::string&, double share) {
                 work.stop_if_asked();
                 tell(progress, share);
             }});
        results.scenes.push_back(std::move(measured.result));
        pictures.push_back(std::move(measured.pictures));
    }
    const std::vector<std::string> written = bench::write_files(results, pictures, output);
    Json pareto = Json::array();
    std::string text;
    for (const bench::SceneResult& scene : results.scenes) {
        text += scene.name + "\n";
        for (const bench::Measured& run : scene.runs) {
            if (run.on_front) pareto.push_back(pareto_row(scene, run));
            text += sentence(run.on_front ? "  * " : "    ", run.name, ": ", run.time.median_ms, " ms, RMSE ",
                             run.error.rmse, ", FLIP ", run.error.flip_mean, "\n");
        }
    }
    if (options.common.json)
        print({{"bench", (output / "bench.json").string()}, {"pareto", pareto}, {"written", written}});
    else
        print_out(text + "* on the front: no other run is better in both\n" + (output / "report.html").string() + "\n");
}

void compare_files(const ErrorBenchOptions& options)
{
    const std::vector<bench::Change> changes = bench::compare(
        bench::read_results(options.compared[0]), bench::read_results(options.compared[1]), !options.ignores_time);
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
                        {"regression", change.is_regression}});
    }
    if (options.common.json)
        print({{"changes", rows}, {"regressions", regressions}});
    else
        print_out(bench::text_of(changes));
    if (regressions > 0)
        throw GateError(sentence(regressions, " of ", changes.size(), " changes are regressions, the first: ",
                                 changes.front().scene, ", ", changes.front().run, ": ", changes.front().what));
}

}  // namespace

void add_bench(CLI::App& program)
{
    auto options = std::make_shared<ErrorBenchOptions>();
    CLI::App* command =
        program.add_subcommand("bench", "Speed against error: each way of drawing against the reference renderer");
    command
        ->add_option(
            "--scenes", options->scenes,
            "Scenes, with commas between: tubes, noisy-surface, tissue, fog, peaks, uint16, anisotropic, paged, "
            "painted, occluded, surfaces, or paths of sessions; without it all of our own")
        ->delimiter(',');
    command->add_flag("--quick", options->quick, "Small volumes, few runs: seconds a scene");
    command->add_option("--rounds", options->rounds, "Timed pictures of each run, in turns")
        ->check(CLI::Range(1, 1000));
    command->add_option(
        "-o,--output", options->output,
        "Folder for bench.json, bench.csv, equal_*.csv, pareto*.svg and .png, report.html; references are "
        "kept there, too");
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
        "  shvr bench --compare before/bench.json after/bench.json");
    command->callback([options] {
        if (options->compared.empty())
            run_scenes(*options);
        else
            compare_files(*options);
    });
}

}  // namespace shvr::cli
