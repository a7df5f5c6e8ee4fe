#include "tools/cli/movie/render_movie.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/live/previewer.h"
#include "engine/movie/frame_folder.h"
#include "engine/movie/movie.h"
#include "engine/movie/movie_encoder.h"
#include "engine/picture/picture_file.h"
#include "engine/session/picture_session.h"
#include "tools/cli/movie/movie_views.h"

namespace shvr::cli {

namespace {

constexpr int DEFAULT_FRAMES = 120;
constexpr double DEFAULT_FRAMES_PER_SECOND = 30.0, MAX_FRAMES_PER_SECOND = 240.0;
constexpr double MAX_TURNTABLE_DEGREES = 360'000.0;

struct Plan {
    std::filesystem::path path;
    bool is_file = false;  ///< a movie file rather than a folder of frames
    std::vector<StatedView> views;
    double degrees = 0.0;
    int frames = DEFAULT_FRAMES;
    double frames_per_second = DEFAULT_FRAMES_PER_SECOND;
};

void check_numbers(const MovieOptions& options)
{
    if (options.frames && (*options.frames < 1 || *options.frames > MAX_MOVIE_FRAMES))
        throw UsageError(
            sentence("--frames is ", *options.frames, "; expected a whole number from 1 to ", MAX_MOVIE_FRAMES));
    const double fps = options.frames_per_second.value_or(DEFAULT_FRAMES_PER_SECOND);
    if (!(fps > 0.0 && fps <= MAX_FRAMES_PER_SECOND))
        throw UsageError(sentence("--fps is ", fps, "; expected frames per second, a number above 0, at most ",
                                  MAX_FRAMES_PER_SECOND));
    const double degrees = options.turntable_degrees.value_or(0.0);
    if (!(std::abs(degrees) <= MAX_TURNTABLE_DEGREES))
        throw UsageError(sentence("--turntable is ", degrees, "; expected degrees, from ", -MAX_TURNTABLE_DEGREES,
                                  " to ", MAX_TURNTABLE_DEGREES));
}

/// Checks everything that can be checked without the volume.
Plan plan_of(const MovieRequest& request)
{
    const MovieOptions& options = request.movie;
    check_numbers(options);
    Plan plan{.path = options.path};
    plan.is_file = is_movie_file(plan.path);
    plan.frames = int(options.frames.value_or(DEFAULT_FRAMES));
    plan.frames_per_second = options.frames_per_second.value_or(DEFAULT_FRAMES_PER_SECOND);
    plan.views = stated_views(options.keys);
    plan.degrees = options.turntable_degrees.value_or(plan.views.empty() ? 360.0 : 0.0);
    if (plan.views.size() == 1 && !options.turntable_degrees)
        throw UsageError("--keys names one view; expected at least two, or --turntable with it");
    if (plan.views.size() > size_t(plan.frames))
        throw UsageError(sentence("--frames is ", plan.frames, "; expected at least one frame for each of the ",
                                  plan.views.size(), " views of --keys"));
    if (plan.is_file) {
        check_output_place(plan.path);
        plan.path = written_path(plan.path);
        if (request.with_session)
            throw UsageError("--with-session is given; expected it without --movie, or with a folder for frames");
        return plan;
    }
    std::error_code ignored;
    if (plan.path.has_extension() && !std::filesystem::is_directory(plan.path, ignored))
        throw UsageError(sentence("--movie is ", in_quotes(plan.path.string()),
                                  "; expected a name that ends in .webm or .mp4, or a folder, without a dot"));
    check_frame_folder(plan.path, plan.frames);
    return plan;
}

/// Draws the frames of a movie, one after another.
class Drawing {
public:
    Drawing(const MovieRequest& request, const Plan& plan, Opened& opened, const Movie& movie, LongWork& work)
        : request_(request), plan_(plan), opened_(opened), movie_(movie), work_(work)
    {}

    void draw();
    bool is_complete() const { return is_complete_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

private:
    void draw_files();
    void draw_movie();
    RenderOptions options_of(const Movie::Frame& frame, int index);
    template <class Job>
    void draw_parts(Job& job, bool (Job::*is_done)() const, int index);
    bool allows_incomplete() const { return *request_.common.allows_incomplete; }

    const MovieRequest& request_;
    const Plan& plan_;
    Opened& opened_;
    const Movie& movie_;
    LongWork& work_;
    int finished_ = 0;  ///< frames
    std::optional<Groups> shown_groups_;
    ui::FigureMemory memory_;
    bool is_complete_ = true;
    std::vector<std::string> warnings_;
};

/// The surfaces of the frame's groups are shown, too.
RenderOptions Drawing::options_of(const Movie::Frame& frame, int index)
{
    Renderer& renderer = *opened_.renderer;
    if (const Groups& before = shown_groups_ ? *shown_groups_ : opened_.session.groups; before != frame.session.groups)
        renderer.scene().show_surfaces(frame.session.surfaces, opened_.annotator->document().trace,
                                       frame.session.groups);
    shown_groups_ = frame.session.groups;
    const Progress progress = [this, index](double fraction) {
        work_.stop_if_asked();
        work_.show((index + fraction) / movie_.frames(), sentence("frame ", index + 1, " of ", movie_.frames()), -1.0);
    };
    const PictureProbe kept_probe = probe_of_picture(request_.input);
    return {.probe = in_picture(shown_probe(frame.session, renderer, *opened_.annotator), kept_probe),
            .outlines_probe = kept_probe == PictureProbe::as_rendered,
            .progress = progress};
}

/// Draws a frame. If it is incomplete, fails unless that is allowed.
template <class Job>
void Drawing::draw_parts(Job& job, bool (Job::*is_done)() const, int index)
{
    while (!(job.*is_done)() && (job.is_complete() || allows_incomplete())) {
        work_.stop_if_asked();
        job.step();
    }
    const Picture picture = job.take();
    for (const std::string& warning : picture.warnings)
        if (std::ranges::find(warnings_, warning) == warnings_.end()) warnings_.push_back(warning);
    is_complete_ = is_complete_ && picture.complete;
    if (picture.complete || allows_incomplete()) return;
    fail(request_.input, ": frame ", index + 1, " is incomplete and not written: ",
         picture.warnings.empty() ? "not all bricks that rays visited could be drawn" : picture.warnings.front(),
         opened_.gaps->has_refused() ? "" : "; --allow-incomplete writes it nevertheless");
}

void Drawing::draw_files()
{
    const FrameFolder folder(plan_.path);
    const PictureProbe kept_probe = probe_of_picture(request_.input);
    for (int index = 0; index < movie_.frames(); ++index) {
        const Movie::Frame frame = movie_.frame(index);
        const std::filesystem::path path = plan_.path / frame_file(index, movie_.frames());
        PictureTexts texts = request_.with_session
                                 ? texts_of_picture(frame.session, frame.camera, path, opened_.project, kept_probe)
                                 : PictureTexts();
        add_figure_texts(texts, request_.figure);
        PictureFile file(path, *opened_.renderer, frame.session, frame.camera, options_of(frame, index), texts,
                         figure_over(request_.figure, opened_, frame.session, frame.camera, warnings_, &memory_));
        draw_parts(file, &PictureFile::is_drawn, index);
        file.commit();
        finished_ = index + 1;
    }
}

void Drawing::draw_movie()
{
    MovieEncoder encoder(plan_.path, opened_.session.render.size, plan_.frames_per_second);
    for (int index = 0; index < movie_.frames(); ++index) {
        const Movie::Frame frame = movie_.frame(index);
        const PictureFile::Over over =
            figure_over(request_.figure, opened_, frame.session, frame.camera, warnings_, &memory_);
        uint32_t first_row = 0;
        PictureJob job(*opened_.renderer, frame.session, frame.camera, options_of(frame, index), [&](ImageF rows) {
            if (over) over(rows, first_row);
            first_row += uint32_t(rows.height);
            encoder.add(rows);
        });
        draw_parts(job, &PictureJob::is_done, index);
        finished_ = index + 1;
    }
    static_cast<void>(work_.begin("writing " + plan_.path.string()));
    encoder.commit();
}

void Drawing::draw()
{
    const auto kept = [&] { return finished_frames(plan_.path, finished_, movie_.frames()); };
    try {
        static_cast<void>(work_.begin("drawing " + plan_.path.string()));
        plan_.is_file ? draw_movie() : draw_files();
    } catch (const Stopped&) {
        if (plan_.is_file)
            fail(plan_.path.string(), ": stopped after ", finished_, " of ", counted(movie_.frames(), "frame"),
                 "; not written");
        fail(plan_.path.string(), ": stopped after ", finished_, " of ", counted(movie_.frames(), "frame"), "; ",
             kept());
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error& error) {
        if (plan_.is_file || finished_ == 0) throw;
        fail(error.what(), "; ", kept());
    }
}

void check_inputs(const MovieRequest& request, const Plan& plan, const std::filesystem::path& volume)
{
    const std::filesystem::path output = plan.is_file ? plan.path : plan.path / frame_file(0, plan.frames);
    check_output_is_not(file_of_input(request.input), output);
    check_output_is_not(volume, output);
    for (const StatedView& view : plan.views)
        if (view.session) check_output_is_not(view.name, output);
}

Movie movie_of(const MovieRequest& request, const Plan& plan, const Opened& opened)
{
    const std::string& camera = request.camera.empty() ? opened.session.camera_name : request.camera;
    std::vector<MovieView> views;
    for (const StatedView& view : plan.views) views.push_back(view_of(view, opened, camera));
    if (views.empty()) views.push_back(view_of({.name = camera}, opened, camera));
    return {std::move(views), plan.degrees, plan.frames, opened.source->info()};
}

void print_movie(const MovieRequest& request, const Plan& plan, const Opened& opened, const Movie& movie,
                 bool is_complete)
{
    Json views = Json::array();
    for (size_t view = 0; view < plan.views.size(); ++view)
        views.push_back({{"view", plan.views[view].name}, {"frame", movie.frame_of_view(view) + 1}});
    const glm::uvec2 size = opened.session.render.size;
    print({{"path", request.movie.path},
           {"frames", movie.frames()},
           {"size", {size.x, size.y}},
           {"fps", plan.frames_per_second},
           {"turntable_degrees", plan.degrees},
           {"views", views},
           {"complete", is_complete && opened.is_complete()},
           {"voxels_not_read", opened.voxels_not_read()},
           {"device", opened.renderer->device().traits().name},
           {"bytes", bytes_of(*opened.renderer)},
           {"warnings", opened.warnings}});
}

}  // namespace

void add_movie_options(CLI::App& command, MovieOptions& options)
{
    CLI::Option* movie = command.add_option(
        "--movie", options.path, "Make a movie instead: .webm or .mp4 (needs ffmpeg), or a folder for PNG frames");
    command
        .add_option("--turntable", options.turntable_degrees, "Degrees of a turn around the volume; 360 without --keys")
        ->needs(movie);
    command
        .add_option("--keys", options.keys,
                    "Views to go through, separated by commas: cameras or sides, JSON (a camera, or settings such as "
                    "{\"camera\":\"left\",\"cut\":{...}}), files with such JSON, sessions, or pictures with a session")
        ->needs(movie);
    command.add_option("--frames", options.frames, sentence("Number of frames (default ", DEFAULT_FRAMES, ")"))
        ->needs(movie);
    command
        .add_option("--fps", options.frames_per_second,
                    sentence("Frames per second of a .webm or .mp4 (default ", DEFAULT_FRAMES_PER_SECOND, ")"))
        ->needs(movie);
}

void render_movie(const MovieRequest& request)
{
    const Plan plan = plan_of(request);
    LongWork work(request.common.quiet);
    const auto check = [&](const Session& session, const VolumeInfo& volume) {
        if (plan.is_file) check_movie_file(plan.path, session.render.size);
        check_inputs(request, plan, session.volume_path);
        check_camera(request.camera, session, volume);
        for (const StatedView& view : plan.views) check_view(view, session, volume);
    };
    Opened opened = open(request.input, request.common, work, {.only_look = true}, check);
    if (plan.is_file) opened.session.render.background.a = 1.0;
    const Movie movie = movie_of(request, plan, opened);
    Drawing drawing(request, plan, opened, movie, work);
    drawing.draw();
    check_validation(opened);
    warn_of_gaps(opened, request.input, request.common);
    warn(drawing.warnings(), request.common);
    for (const std::string& warning : drawing.warnings()) opened.warnings.push_back(warning);
    if (!request.common.json) return say(request.common, request.movie.path);
    print_movie(request, plan, opened, movie, drawing.is_complete());
}

}  // namespace shvr::cli
