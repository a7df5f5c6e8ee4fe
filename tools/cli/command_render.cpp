// shvr render: a picture of a session, a project or a bare volume.

#include <atomic>
#include <csignal>

#include "engine/base/file.h"
#include "engine/live/previewer.h"
#include "engine/picture/picture_file.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct RenderCommandOptions {
    Common common;
    std::string input, output, size, camera, transfer_function;
    bool allows_incomplete = false;
};

/// Why a picture is incomplete.
std::string why_incomplete(const Picture& picture)
{
    return picture.warnings.empty() ? "not all bricks that rays visited could be drawn" : picture.warnings.front();
}

std::atomic<bool> render_is_stopped = false;

extern "C" void stop_rendering(int signal_number)
{
    render_is_stopped = true;
    std::signal(signal_number, SIG_DFL);  // a second one ends the program at once
}

/// Draws all parts. Fails, and leaves the old file as it was, where the picture lacks something or is stopped.
Picture draw(PictureFile& file, const RenderCommandOptions& options)
{
    while (!file.is_drawn() && (file.is_complete() || options.allows_incomplete)) {
        if (render_is_stopped) fail(options.output, ": stopped at ", int(100.0 * file.progress()), " %; not written");
        file.step();
    }
    Picture picture = file.take();
    if (!picture.complete && !options.allows_incomplete)
        fail(options.input, ": the picture is incomplete and not written: ", why_incomplete(picture),
             "; --allow-incomplete writes it nevertheless");
    file.commit();
    return picture;
}

void run_render(RenderCommandOptions options)
{
    check_output("--output", options.output, {".png", ".pfm"});
    if (!options.size.empty()) {
        const glm::uvec2 size = parse_size(options.size);
        options.common.settings.push_back(sentence("render.size=[", size.x, ",", size.y, "]"));
    }
    if (!options.transfer_function.empty()) {
        const bool is_file = std::filesystem::exists(options.transfer_function);
        options.common.settings.push_back("transfer_function=" +
                                          (is_file ? read_text(options.transfer_function, 1 << 20)
                                                   : Json{{"preset", options.transfer_function}}.dump()));
    }
    Opened opened = open(options.input, options.common);
    const std::string& wanted = options.camera.empty() ? opened.session.camera_name : options.camera;
    const Camera camera = camera_named(opened.session, wanted, opened.source->info());
    const std::optional<ProbeLook> probe = shown_probe(opened.session, *opened.renderer, *opened.annotator);
    // From here on there is a file to take away.
    std::signal(SIGINT, stop_rendering);
    std::signal(SIGTERM, stop_rendering);
    std::signal(SIGXFSZ, SIG_IGN);  // exceeding the file size limit is then an error like a full disk
    PictureFile file(options.output, *opened.renderer, opened.session, camera,
                     {.probe = probe, .outlines_probe = true, .count_work = options.common.json});
    const Picture picture = draw(file, options);
    check_validation(opened);
    warn(picture.warnings, options.common);
    for (const std::string& warning : picture.warnings) opened.warnings.push_back(warning);
    if (!options.common.json) return say(options.common, options.output);

    Json passes = Json::array();
    for (const gpu::PassReport& pass : picture.passes)
        passes.push_back({{"name", pass.name}, {"gpu_ms", pass.timed ? Json(pass.gpu_ms) : Json(nullptr)}});
    const glm::uvec2 size = opened.session.render.size;
    print({{"output", options.output},
           {"size", {size.x, size.y}},
           {"complete", picture.complete},
           {"device", opened.renderer->device().traits().name},
           {"passes", passes},
           {"counters", counters_of(picture.passes)},
           {"bytes", bytes_of(*opened.renderer)},
           {"bricks", bricks_of(*opened.renderer)},
           {"warnings", opened.warnings}});
}

}  // namespace

void add_render(CLI::App& program)
{
    auto options = std::make_shared<RenderCommandOptions>();
    CLI::App* command = program.add_subcommand("render", "Makes a picture");
    command->add_option("INPUT", options->input, "Session (.json), project folder or volume")->required();
    command
        ->add_option("-o,--output", options->output,
                     "Picture to write: .png, or .pfm for linear light in 32-bit floats")
        ->required();
    command->add_option("--size", options->size, "Pixels, as in 512x384");
    command->add_option("--camera", options->camera, "A camera of the session, a side (front, top, ...) or JSON");
    command->add_option(
        "--tf", options->transfer_function,
        "Transfer function: a preset (bundles, haze, heat, layers, surface), or a JSON file with its points");
    command->add_flag("--allow-incomplete", options->allows_incomplete,
                      "Write a picture that lacks something, with a warning, instead of failing");
    add_belief_option(*command, options->common);
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer("Example:\n  shvr render scan.nhdr -o scan.png --size 800x600 --camera front");
    command->callback([options] { run_render(*options); });
}

}  // namespace shvr::cli
