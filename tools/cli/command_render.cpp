// shvr render: draws a picture of a session, a project or a bare volume.

#include <cmath>

#include "engine/base/file.h"
#include "engine/base/image_tiff.h"
#include "engine/live/previewer.h"
#include "engine/picture/picture_file.h"
#include "engine/session/picture_session.h"
#include "tools/cli/array/ranks_job.h"
#include "tools/cli/array/render_bands.h"
#include "tools/cli/array/render_ranks.h"
#include "tools/cli/cli.h"
#include "tools/cli/figure/figure_options.h"
#include "tools/cli/movie/render_movie.h"

namespace shvr::cli {

namespace {

struct RenderCommandOptions {
    Common common;
    std::string input, output, size, camera, transfer_function;
    std::string task;  ///< as add_task_option has it
    bool with_session = false;
    MovieOptions movie;
    FigureOptions figure;
};

/// Why a picture is incomplete.
std::string why_incomplete(const Picture& picture)
{
    return picture.warnings.empty() ? "not all bricks that rays visited could be drawn" : picture.warnings.front();
}

/// Describes the detail of a complete picture: if `render.detail` is above 0, paged volumes with several levels are
/// drawn at coarser levels than resident volumes.
Json detail_of(const Renderer& renderer, const RenderSettings& render)
{
    const int level = renderer.volume().finest_level();
    return {{"setting", render.detail},
            {"finest_level", level},
            {"voxels_per_side", int64_t{1} << level},
            {"step_voxels", std::ldexp(render.step_voxels, level)}};
}

/// Draws all parts. If the picture is incomplete or the work is cancelled, fails and keeps the old file unchanged.
Picture draw(PictureFile& file, const Opened& opened, const RenderCommandOptions& options, LongWork& work)
{
    try {
        while (!file.is_drawn() && (file.is_complete() || *options.common.allows_incomplete)) {
            work.stop_if_asked();
            file.step();
        }
        static_cast<void>(work.begin("writing " + options.output));
    } catch (const Stopped&) {
        fail(options.output, ": stopped at ", int(100.0 * file.progress()), " %; not written");
    }
    Picture picture = file.take();
    if (!picture.complete && !*options.common.allows_incomplete)
        fail(options.input, ": the picture is incomplete and not written: ", why_incomplete(picture),
             opened.gaps->has_refused() ? "" : "; --allow-incomplete writes it nevertheless");
    file.commit();
    return picture;
}

/// Turns --size and --tf into settings.
void take_shorthands(RenderCommandOptions& options)
{
    if (!options.size.empty()) {
        const glm::uvec2 size = take_picture_size(options.size, options.figure);
        options.common.settings.push_back(sentence("render.size=[", size.x, ",", size.y, "]"));
    }
    if (!options.transfer_function.empty()) {
        const bool is_file = std::filesystem::exists(options.transfer_function);
        options.common.settings.push_back("transfer_function=" +
                                          (is_file ? read_text(options.transfer_function, 1 << 20)
                                                   : Json{{"preset", options.transfer_function}}.dump()));
    }
}

/// Meets the processes that mpirun has started. Fails if they cannot share what is asked for.
Ranks& ranks_for(const RenderCommandOptions& options)
{
    if (const std::optional<std::string> why = why_not_shared()) warn({*why}, options.common);
    Ranks& ranks = join_ranks();
    const bool is_movie = !options.movie.path.empty();
    if (ranks.count() > 1 && (is_movie || !options.task.empty()))
        throw UsageError(sentence(is_movie ? "--movie" : "--task", " is given, and mpirun has started ", ranks.count(),
                                  " processes; expected -o, since they draw one picture together"));
    return ranks;
}

/// The picture of several processes. Null on other ranks than 0, which neither write nor print.
std::optional<RanksResult> draw_together(Ranks& ranks, Opened& opened, const RanksPicture& wanted,
                                         const RenderCommandOptions& options, LongWork& work)
{
    const RanksWatch watch(ranks, options.output);
    return render_with_ranks(ranks, opened, wanted, options.common, work);
}

/// What --json prints.
Json report_of(Opened& opened, const Picture& picture, const std::optional<RanksResult>& together,
               const RenderCommandOptions& options)
{
    Json passes = Json::array();
    for (const gpu::PassReport& pass : picture.passes)
        passes.push_back({{"name", pass.name}, {"gpu_ms", pass.timed ? Json(pass.gpu_ms) : Json(nullptr)}});
    const glm::uvec2 size = opened.session.render.size;
    Json report{{"output", options.output},
                {"size", {size.x, size.y}},
                {"complete", picture.complete && opened.is_complete() && (!together || together->is_whole)},
                {"voxels_not_read", opened.voxels_not_read()},
                {"detail", detail_of(*opened.renderer, opened.session.render)},
                {"device", opened.renderer->device().traits().name},
                {"passes", passes},
                {"counters", counters_of(picture.passes)},
                {"bytes", bytes_of(*opened.renderer)},
                {"bricks", bricks_of(*opened.renderer)},
                {"warnings", opened.warnings}};
    if (together) {
        report["split"] = together->split;
        report["ranks"] = together->ranks;
    }
    return report;
}

/// Opens the input. A TIFF of several channels may be a picture that was made here, and is to be rendered again.
Opened open_input(const RenderCommandOptions& options, LongWork& work, const CheckSession& check)
{
    try {
        return open(options.input, options.common, work, {.only_look = true}, check);
    } catch (const UsageError&) {
        throw;
    } catch (const Error& error) {
        const std::string why = error.what();
        if (!is_tiff_name(options.input) || why.find(" channels (") == std::string::npos) throw;
        fail(why, "; a picture is rendered again if it was made with --with-session");
    }
}

void run_render(RenderCommandOptions options)
{
    Ranks& ranks = ranks_for(options);
    if (options.output.empty() == options.movie.path.empty())
        throw UsageError(options.output.empty() ? "--output is missing; expected -o for a picture, or --movie"
                                                : "--output and --movie are given; expected one of them");
    check_figure(options.figure, options.input, !options.size.empty());
    if (!options.movie.path.empty() && !options.task.empty())
        throw UsageError("--task and --movie are given; expected one of them, since a movie is not split");
    if (!options.movie.path.empty()) {
        take_shorthands(options);
        return render_movie(
            {options.common, options.input, options.camera, options.with_session, options.figure, options.movie});
    }
    check_output("--output", options.output, {".png", ".tif", ".tiff", ".pfm"});
    options.output = written_path(options.output).string();
    check_output_is_not(file_of_input(options.input), options.output);
    take_shorthands(options);
    SplitJob job(options.task, options.output, options.common);
    if (job.gathers()) {
        job.begin({});
        return join_bands(job, options.output, options.common);
    }
    if (job.is_task()) {
        job.begin(inputs_of(options.input, open_unmeasured_session(options.input, options.common.settings).session));
        if (job.is_done()) return job.report();
    }
    LongWork work(options.common.quiet);
    const auto check = [&](const Session& session, const VolumeInfo& volume) {
        check_output_is_not(session.volume_path, options.output);
        check_camera(options.camera, session, volume);
    };
    Opened opened = open_input(options, work, check);
    const std::string& wanted = options.camera.empty() ? opened.session.camera_name : options.camera;
    const Camera camera = camera_named(opened.session, wanted, opened.source->info());
    const PictureProbe kept_probe = probe_of_picture(options.input);
    const std::optional<ProbeLook> probe =
        in_picture(shown_probe(opened.session, *opened.renderer, *opened.annotator), kept_probe);
    const Progress progress = work.begin("drawing " + options.output);
    const RenderOptions how{.probe = probe,
                            .outlines_probe = kept_probe == PictureProbe::as_rendered,
                            .count_work = options.common.json,
                            .progress = progress};
    PictureTexts texts = options.with_session
                             ? texts_of_picture(opened.session, camera, options.output, opened.project, kept_probe)
                             : PictureTexts();
    add_figure_texts(texts, options.figure);
    std::vector<std::string> left_out;
    const PictureFile::Over over = figure_over(options.figure, opened, opened.session, camera, left_out);
    if (job.is_task()) {
        draw_band(job, opened, camera, {how, texts, over, left_out}, options.common, work);
        return job.report();
    }
    std::optional<RanksResult> together;
    Picture picture;
    if (ranks.count() > 1) {
        together =
            draw_together(ranks, opened, {camera, how, texts, over, options.input, options.output}, options, work);
        if (!together) return;
        picture = std::move(together->picture);
    } else {
        PictureFile file(options.output, *opened.renderer, opened.session, camera, how, texts, over);
        picture = draw(file, opened, options, work);
    }
    check_validation(opened);
    warn_of_gaps(opened, options.input, options.common);
    left_out.insert(left_out.begin(), picture.warnings.begin(), picture.warnings.end());
    warn(left_out, options.common);
    for (const std::string& warning : left_out) opened.warnings.push_back(warning);
    if (!options.common.json) return say(options.common, options.output);

    print(report_of(opened, picture, together, options));
}

}  // namespace

void add_render(CLI::App& program)
{
    auto options = std::make_shared<RenderCommandOptions>();
    CLI::App* command = program.add_subcommand("render", "Makes a picture or a movie");
    command
        ->add_option("INPUT", options->input,
                     "Session (.json), project folder, volume, or a picture that was made here")
        ->required();
    command->add_option("-o,--output", options->output,
                        "Picture to write: .png, .tif, or .pfm for linear light in 32-bit floats");
    command->add_option("--size", options->size, "Pixels, as in 512x384, or millimetres at --dpi, as in 85x60mm");
    command->add_option("--camera", options->camera, "A camera of the session, a side (front, top, ...) or JSON");
    command->add_option("--tf", options->transfer_function,
                        "Transfer function: a preset (bundles, viridis, ...), or a JSON file with its points");
    command->add_flag(
        "--with-session", options->with_session,
        "Keep the session in the .png or .tif, and what is drawn over it, so that it can be rendered again, as the "
        "window's pictures do");
    add_figure_options(*command, options->figure);
    add_movie_options(*command, options->movie);
    add_task_option(*command, options->task);
    add_incomplete_option(*command, options->common,
                          "Write a picture that lacks something, with a warning, instead of failing");
    add_belief_option(*command, options->common);
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "A volume of several levels, paged, is drawn from voxels about as large as a pixel, and what is thinner may "
        "not\n"
        "show; --set render.detail=0 draws all voxels, as a resident volume always is. Either picture is complete:\n"
        "\"detail\" in --json tells which it is.\n\n"
        "--scale-bar, --color-bar, --legend, --axes, --measurements, --title and --text are drawn in black or white,\n"
        "whichever stands out from the background, or over a scan in a slice from its dark air; black on a\n"
        "transparent background. In perspective the scale bar holds at the camera's target, the middle of the view.\n"
        "Texts that do not fit are wrapped or shortened and other elements left out, with a warning. A picture that\n"
        "keeps its session keeps them, too. Rendered again, it has them again; if any is given then, only the given\n"
        "ones, and with --no-elements none.\n\n"
        "A movie goes from view to view of --keys, slowing down at each: the camera turns the shortest way, and\n"
        "transfer function, groups, light and cuts change along. --turntable turns at constant speed about the\n"
        "axis of the volume that points upwards, with --keys in addition. Each run makes the same frames. A .webm or\n"
        ".mp4 has an opaque background.\n\n"
        "mpirun -n N shvr render draws one picture by N processes, if shvr was built with -DSHVR_MPI=ON.\n\n"
        "Example:\n  shvr render scan.nhdr -o scan.png --size 800x600 --camera front\n"
        "  shvr render project/ -o figure.png --scale-bar --legend --title 'Bellis' --text 40,52.5,7:stem\n"
        "  shvr render project/ -o column.tif --size 85x60mm --dpi 600 --set 'render.background=\"#ffffff00\"'\n"
        "  shvr render project/ --movie turn.webm --turntable 360 --frames 240\n"
        "  shvr render project/ --movie frames/ --keys 'front,{\"camera\":\"top\",\"cut\":{\"upper\":[99,99,50]}}'");
    command->callback([options] { run_render(*options); });
}

}  // namespace shvr::cli
