// shvr profile: measures the time of a frame, pass by pass; shvr profile diff: compares two profiles.

#include <chrono>
#include <iostream>

#include "engine/base/atomic_writer.h"
#include "engine/base/file.h"
#include "engine/live/previewer.h"
#include "tools/cli/profile/profile_session.h"

namespace shvr::cli {

namespace {

constexpr int64_t MAX_PROFILE_BYTES = int64_t(64) << 20;
constexpr int DEEPEST_PROFILE = 16;  // SHVR's profiles nest 4 deep; each level costs far more memory than 2 characters

struct ProfileCommandOptions {
    Common common;
    std::string input, size, camera, trace, csv, graph, html, script;
    int frames = 20;
    int replays = 1;  ///< repetitions of the script
    int warmup = 3;   ///< frames not measured: they compile kernels and wake up the device
    bool serialize = false;
    std::string a, b;  ///< files of diff
};

void print_text(const std::string& text)
{
    clear_progress();
    std::cout << text << std::flush;
    if (!std::cout) fail("standard output: cannot be written");
}

/// Refuses incomplete frames, since they take less time than complete ones.
void expect_complete(const Picture& picture, const Opened& opened, const ProfileCommandOptions& options)
{
    if (picture.complete || *options.common.allows_incomplete) return;
    fail(options.input, ": the picture is incomplete: ",
         picture.warnings.empty() ? "not all bricks that rays visited could be drawn" : picture.warnings.front(),
         opened.gaps->has_refused() ? "" : "; --allow-incomplete measures it nevertheless");
}

Profile measure_frames(const ProfileCommandOptions& options, Opened& opened, LongWork& work)
{
    Renderer& renderer = *opened.renderer;
    const std::string& camera_name = options.camera.empty() ? opened.session.camera_name : options.camera;
    const Camera camera = camera_named(opened.session, camera_name, opened.source->info());
    const gpu::DeviceTraits& traits = renderer.device().traits();
    Profile profile{.input = options.input,
                    .device = traits.name,
                    .driver = traits.driver,
                    .size = opened.session.render.size,
                    .warmup = options.warmup,
                    .serialize = options.serialize};
    if (traits.timestamp_bits == 0)
        profile.warnings.push_back(sentence(traits.name, " has no timestamp queries; passes are not timed"));

    say(options.common, sentence(options.warmup, " frames to warm up, ", options.frames, " to measure"));

    using Milliseconds = std::chrono::duration<double, std::milli>;
    const auto started = std::chrono::steady_clock::now();
    const auto now = [&] { return Milliseconds(std::chrono::steady_clock::now() - started).count(); };
    double measured_from = 0.0;  // milliseconds
    const std::optional<ProbeLook> probe = shown_probe(opened.session, *opened.renderer, *opened.annotator);
    const int frames = options.warmup + options.frames;
    const Progress progress = work.begin("drawing frames");
    for (int i = 0; i < frames; ++i) {
        tell(progress, double(i) / double(frames));
        const double begin = now();
        Picture picture = renderer.render(opened.session, camera, {.probe = probe, .serialize = options.serialize});
        const double end = now();
        if (i == 0) {
            profile.first_frame = picture.passes;
            expect_complete(picture, opened, options);
            profile.complete = picture.complete;
        }
        if (i < options.warmup) continue;
        if (i == options.warmup) {
            measured_from = begin;
            profile.measured_from =
                started + std::chrono::duration_cast<std::chrono::steady_clock::duration>(Milliseconds(begin));
        }
        profile.frames.push_back({.begin_ms = begin - measured_from,
                                  .end_ms = end - measured_from,
                                  .wall_ms = picture.wall_ms,
                                  .device_bytes = renderer.memory().device_bytes(),
                                  .passes = std::move(picture.passes)});
        profile.graph = std::move(picture.graph);
    }
    profile.bytes = bytes_of(renderer);
    warn_of_gaps(opened, options.input, options.common);
    profile.complete = profile.complete && opened.is_complete();
    profile.voxels_not_read = opened.voxels_not_read();
    profile.warnings.insert(profile.warnings.begin(), opened.warnings.begin(), opened.warnings.end());
    profile.device_budget = renderer.memory().device_budget();
    profile.host_budget = renderer.host_budget();
    // Counting work costs time, so it is done in a separate frame.
    profile.counted =
        renderer.render(opened.session, camera, {.probe = probe, .count_work = true, .statistics = true}).passes;
    return profile;
}

void run_session(const ProfileCommandOptions& options)
{
    const SessionProfile profile = profile_session(options.input, options.script, options.replays, options.common);
    Json summary = summary_of(profile);
    summary["written"] = Json::array();
    const auto write = [&](const std::string& path, const auto& form) {
        if (path.empty()) return;
        write_text(path, form());
        summary["written"].push_back(path);
    };
    write(options.trace, [&] { return trace_of(profile); });
    write(options.csv, [&] { return csv_of(profile); });
    write(options.html, [&] { return page_of(profile); });
    if (options.common.json)
        print(summary);
    else
        print_text(session_text(summary));
}

void run_profile(ProfileCommandOptions options)
{
    if (options.input.empty())
        throw UsageError("INPUT is missing; expected a session (.json), project folder or volume");
    check_output("--trace", options.trace, {".json"});
    check_output("--csv", options.csv, {".csv"});
    check_output("--html", options.html, {".html"});
    check_output("--graph", options.graph, {".dot", ".svg", ".json"});
    const std::pair<const char*, const std::string&> outputs[] = {
        {"--trace", options.trace}, {"--csv", options.csv}, {"--html", options.html}, {"--graph", options.graph}};
    for (const auto& [option, output] : outputs)
        for (const auto& [other, same] : outputs)
            if (&output < &same && !output.empty() && !same.empty() && link_target(output) == link_target(same))
                throw UsageError(
                    sentence(option, " and ", other, " are both '", output, "'; expected a file for each"));
    for (const std::string& output : {options.trace, options.csv, options.html, options.graph})
        for (const std::string& input : {options.input, options.script})
            check_output_is_not(file_of_input(input), output);
    if (!options.size.empty()) {
        const glm::uvec2 size = parse_size(options.size);
        options.common.settings.push_back(sentence("render.size=[", size.x, ",", size.y, "]"));
    }
    if (!options.script.empty()) return run_session(options);
    LongWork work(options.common.quiet);
    const auto check = [&](const Session& session, const VolumeInfo& volume) {
        check_camera(options.camera, session, volume);
    };
    Opened opened = open(options.input, options.common, work, {.only_look = true}, check);
    const Profile profile = measure_frames(options, opened, work);
    check_validation(opened);

    Json written = Json::array();
    const auto write = [&](const std::string& path, const auto& how) {
        if (path.empty()) return;
        how();
        written.push_back(path);
    };
    write(options.trace, [&] { write_text(options.trace, trace_of(profile)); });
    write(options.csv, [&] { write_text(options.csv, csv_of(profile)); });
    write(options.html, [&] { write_text(options.html, page_of(profile)); });
    write(options.graph, [&] { write_graph(options.graph, profile.graph); });

    Json summary = summary_of(profile);
    summary["written"] = written;
    if (options.common.json)
        print(summary);
    else
        print_text(text_of(summary));
}

Json read_profile(const std::string& path)
{
    const auto check_depth = [&](int depth, Json::parse_event_t /*event*/, Json& /*value*/) {
        if (depth > DEEPEST_PROFILE)
            fail(path, ": JSON nests deeper than ", DEEPEST_PROFILE,
                 " levels; expected what shvr profile --json prints");
        return true;
    };
    const Json summary = Json::parse(read_text(path, MAX_PROFILE_BYTES), check_depth, false);
    if (summary.is_discarded()) fail(path, ": is not JSON; expected what shvr profile --json prints");
    return summary;
}

void run_diff(const ProfileCommandOptions& options)
{
    const Json difference = difference_of(read_profile(options.a), options.a, read_profile(options.b), options.b);
    if (options.common.json)
        print(difference);
    else
        print_text(difference_text(difference));
}

void add_diff(CLI::App& profile, const std::shared_ptr<ProfileCommandOptions>& options)
{
    CLI::App* command = profile.add_subcommand("diff", "What changed from profile A to profile B");
    command->add_option("A", options->a, "What shvr profile --json printed")->required();
    command->add_option("B", options->b, "The same of a later run")->required();
    add_output_options(*command, options->common);
    command->footer("Example:\n  shvr profile diff before.json after.json");
    command->callback([options] { run_diff(*options); });
}

}  // namespace

void add_profile(CLI::App& program)
{
    auto options = std::make_shared<ProfileCommandOptions>();
    CLI::App* command = program.add_subcommand("profile", "Times the passes of a frame");
    command->add_option("INPUT", options->input, "Session (.json), project folder or volume");
    command->add_option("--frames", options->frames, "Frames to measure")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--warmup", options->warmup, "Frames to discard first")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    command->add_option("--size", options->size, "Pixels, as in 512x384");
    command->add_option("--camera", options->camera, "A camera of the session, a side (front, top, ...) or JSON");
    command->add_option("--trace", options->trace, "Trace to write (.json), for ui.perfetto.dev or chrome://tracing");
    command->add_option("--csv", options->csv, "Table to write (.csv): one row per frame and pass");
    command->add_option("--graph", options->graph, "Frame graph to write (.dot, .svg, .json)");
    command->add_option("--html", options->html,
                        "Page to write (.html): passes and memory over time, in one file that needs nothing else");
    CLI::Option* const script = command->add_option("--script", options->script,
                                                    "Actions to time one by one instead of frames, as shvr view --log "
                                                    "writes them; the journal keeps what they paint");
    command->add_flag("--serialize", options->serialize, "A full barrier between passes: times that do not overlap");
    add_incomplete_option(*command, options->common, "Measure pictures that lack something, instead of failing");
    for (const char* of_frames : {"--frames", "--warmup", "--camera", "--graph", "--serialize", "--allow-incomplete"})
        script->excludes(command->get_option(of_frames));
    command
        ->add_option("--replays", options->replays,
                     "How often the script is done; from 3 on a diff knows the noise. All but the last are done on "
                     "copies of the work, which are removed")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str()
        ->needs(script);
    add_belief_option(*command, options->common);
    add_outside_option(*command, options->common);
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    add_diff(*command, options);
    command->footer(
        "Example:\n  shvr profile scan.nhdr --frames 100 --json > before.json\n"
        "  shvr profile diff before.json after.json\n"
        "  shvr profile copy/ --script session.jsonl --replays 5 --html session.html");
    command->callback([options, command] {
        if (!command->got_subcommand("diff")) run_profile(*options);
    });
}

}  // namespace shvr::cli
