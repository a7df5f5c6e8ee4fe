// shvr view: the window.

#include <algorithm>
#include <cstdlib>

#include "engine/base/assets.h"
#include "tools/cli/cli.h"
#include "tools/cli/stop.h"
#include "tools/cli/stop_deadline.h"
#include "ui/app.h"

namespace shvr::cli {

namespace {

struct ViewCommandOptions {
    Common common;
    std::string input, size, log;
    bool allow_force = false;
};

/// {count, median, p95, max}
Json summary(std::vector<double> values)
{
    if (values.empty()) return {{"count", 0}, {"median", nullptr}, {"p95", nullptr}, {"max", nullptr}};
    std::ranges::sort(values);
    const auto at = [&](double share) {
        return values[std::min(values.size() - 1, size_t(share * double(values.size())))];
    };
    return {{"count", values.size()}, {"median", at(0.5)}, {"p95", at(0.95)}, {"max", values.back()}};
}

Json summary(const TimeHistogram& histogram)
{
    return {{"count", histogram.total()},
            {"p50_us", histogram.quantile_us(0.5)},
            {"p99_us", histogram.quantile_us(0.99)},
            {"max_us", double(histogram.worst_ns) * 1e-3}};
}

Json json_of(const std::optional<double>& value)
{
    return value ? Json(*value) : Json(nullptr);
}

Json json_of(const ui::AppReport& report)
{
    Json groups = Json::object();
    for (size_t group = 1; group < report.voxels_by_group.size(); ++group)
        if (report.voxels_by_group[group] > 0) groups[std::to_string(group)] = report.voxels_by_group[group];
    const glm::dvec3& probe = report.probe_voxel;
    return {{"device", report.gpu_name},
            {"frames", report.frames},
            {"ui_frame_ms", summary(report.frame_ms)},
            {"ui_own_ms", {{"idle", summary(report.own_idle_ms)}, {"busy", summary(report.own_busy_ms)}}},
            {"ui_interval_ms", summary(report.interval_ms)},
            {"input_to_screen_ms", summary(report.input_ms)},
            {"first_picture_ms", json_of(report.first_picture_ms)},
            {"sharp_picture_ms", json_of(report.sharp_picture_ms)},
            {"relevance_ms", summary(report.relevance_ms)},
            {"servo",
             {{"ticks", report.servo.ticks},
              {"late_ticks", report.servo.late_ticks},
              {"lateness", summary(report.servo.lateness)},
              {"duration", summary(report.servo.duration)},
              {"relevance_age", summary(report.servo.relevance_age)}}},
            {"view_submissions", report.view_submissions},
            {"view_complete", report.view_complete},
            {"probe_voxel", {probe.x, probe.y, probe.z}},
            {"voxels_in_group", groups},
            {"undoable", report.undoable},
            {"redoable", report.redoable},
            {"previewed_voxels", report.previewed_voxels ? Json(*report.previewed_voxels) : Json(nullptr)},
            {"messages", report.messages}};
}

void run_view(const ViewCommandOptions& options)
{
    const Common& common = options.common;
    const char* const validation = std::getenv("SHVR_VALIDATION");
    const char* const screen_texts = std::getenv("SHVR_SCREEN_TEXTS");  // for tests: ui/screen_text.h
    ui::AppOptions wanted{.input = options.input,
                          .settings = common.settings,
                          .device = common.device,
                          .budget = {common.budget_device_mib << 20, common.budget_host_mib << 20},
                          .threads = common.threads,
                          .validation = validation && *validation == '1',
                          .saves_outside = common.outside,
                          .allow_force = options.allow_force,
                          .settings_folder = config_folder(),
                          .log = options.log,
                          .screen_texts = screen_texts ? screen_texts : "",
                          .version = SHVR_VERSION};
    wanted.keeps_place = options.size.empty();
    if (!options.size.empty()) wanted.window_size = parse_size(options.size);
    constexpr std::chrono::milliseconds MOST{700};  // systems kill a process after a second; it must end before that
    const StopRequest stop;
    const StopDeadline deadline(MOST);
    wanted.stop = &stop.flag();
    ui::App app(wanted);
    app.run();
    const ui::AppReport report = app.report();
    if (common.json) print(json_of(report));
    if (stop.is_made()) {
        std::string said = sentence("shvr: ", StopRequest::in_words());
        for (const std::string& loss : report.stop_losses) said += "; " + loss;
        print_beside_progress(said);
    }
    if (!report.validation_messages.empty())
        fail(report.validation_messages.size(),
             " validation messages, the first: ", report.validation_messages.front());
}

}  // namespace

void add_view(CLI::App& program)
{
    auto options = std::make_shared<ViewCommandOptions>();
    CLI::App* command = program.add_subcommand("view", "Opens the window; so does shvr alone");
    command->add_option(
        "INPUT", options->input,
        "Session (.json), project folder, volume or the address of an OME-Zarr; none: drop one onto it");
    command->add_option("--size", options->size,
                        "Size of the window, as in 1280x800; without it, size and place of the last time");
    command->add_flag("--allow-force", options->allow_force,
                      "Let a haptic device put force on the hand; one on HID only with a verified profile");
    command->add_option("--log", options->log, "Write each action as a line that shvr annotate replays");
    add_outside_option(*command, options->common);
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "With --json the run's timings and counts are printed when the window closes.\n"
        "Example:\n  shvr view project/\n  shvr view https://host/scan.zarr");
    command->callback([options] { run_view(*options); });
}

}  // namespace shvr::cli
