#include "engine/workbench/services/photographer.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "engine/base/machine/clipboard.h"
#include "engine/base/text.h"
#include "engine/movie/movie.h"
#include "engine/session/looks/key_look.h"
#include "engine/session/picture_session.h"
#include "engine/session/words/number_words.h"
#include "engine/workbench/actions/figure_text.h"
#include "engine/workbench/desk/declined.h"
#include "engine/workbench/lists/group_list.h"
#include "engine/workbench/models/preferences.h"
#include "engine/workbench/sight/print_size.h"

namespace shvr::ui {

namespace {

constexpr uint32_t PART_PIXELS = 96;  ///< bounds the delay when the user resumes

std::vector<std::string> views_named_in(const std::string& text)
{
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        if (!line.empty()) lines.push_back(line);
    return lines;
}

/// Returns "1004 x 756 pixels, 85 x 64 mm at 300 dots per inch".
std::string size_of_figure(const glm::uvec2& pixels, double dots_per_inch)
{
    std::string words = sentence(pixels.x, " x ", pixels.y, " pixels");
    if (dots_per_inch == 0.0) return words;
    const glm::dvec2 mm = glm::round(glm::dvec2(pixels) * MM_PER_INCH / dots_per_inch * 10.0) / 10.0;
    return words + sentence(", ", mm.x, " x ", mm.y, " mm at ", dots_per_inch, " dots per inch");
}

/// Copies a picture to the clipboard, and removes its file.
void hand_over(const std::filesystem::path& file)
{
    const auto remove = [&] {
        std::error_code ignored;
        std::filesystem::remove(file, ignored);
    };
    try {
        copy_png(file);
    } catch (...) {
        remove();
        throw;
    }
    remove();
}

}  // namespace

Photographer::Photographer(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

void Photographer::advance()
{
    attempt(photographing_, [this] {
        try {
            follow_screenshots();
        } catch (...) {
            others_.stay_open();
            throw;
        }
        follow_project_picture();
    });
}

/// Takes the picture of the start page once the view is sharp.
void Photographer::follow_project_picture()
{
    if (options_.is_script || options_.settings.empty() || !options_.has_preferences) return;
    if (!project_pictures_.is_wanted(desk_.openings, document_->is_saved())) return;
    const std::vector<Screen::Part>& parts = document_->screen.parts();
    if (parts.empty() || !parts.front().view->shown_camera()) return;  // nothing is drawn yet
    if (!document_->screen.complete() || screenshots_.has_large() || document_->annotator.stroke_is_running()) return;
    const std::vector<std::filesystem::path> recent = model().preferences.recent;
    if (!recent.empty())
        project_pictures_.take(desk_.openings, document_->screen, options_.settings / "pictures", recent);
}

void Photographer::drop_large(const char* by)
{
    if (!screenshots_.has_large()) return;
    const std::string kept = screenshots_.large()->kept();
    const std::string name = screenshots_.large()->name();
    screenshots_.drop_large();
    others_.stay_open();
    say(sentence("The ", name, " was cancelled by ", by, kept.empty() ? "" : "; ", kept), Weight::warning);
}

void Photographer::follow_screenshots()
{
    if (document_->annotator.stroke_is_running()) drop_large("painting");  // only some parts would show it
    if (document_->annotator.is_behind()) return;  // the picture lacks offsets whose voxels are being read
    const Screenshots::Turn turn =
        screenshots_.advance(document_->screen, stem(), is_still_, texts_of_picture(others_.pixels(), true),
                             [this] { return figure_of_picture(1); });
    if (!turn.said.empty()) say(turn.said);
    if (!turn.progress.empty())
        progress_message_ = desk_.messages.amend(progress_message_, options_.now_s(), turn.progress);
}

void Photographer::say_begun(std::string text, Weight weight)
{
    say(std::move(text), weight);
    progress_message_ = weight == Weight::done ? desk_.messages.count() : 0;  // a warning stays
}

std::filesystem::path Photographer::stem() const
{
    const std::filesystem::path stem = std::filesystem::path(document_->session_path).replace_extension();
    // The example's session lies in a hidden folder, where the user would not look for pictures.
    const bool is_example = stem.parent_path() == options_.settings / "example";
    const char* const home = std::getenv("HOME");
    return is_example && home && *home ? std::filesystem::path(home) / stem.filename() : stem;
}

bool Photographer::cancel(Jobs::Number number)
{
    if (number != PICTURE_JOB || !has_large()) return false;
    const std::string kept = screenshots_.large()->kept();
    const std::string name = screenshots_.large()->name();
    screenshots_.drop_large();
    say(sentence("Cancelled: the ", name, kept.empty() ? "" : "; ", kept),
        kept.empty() ? Weight::done : Weight::warning);
    return true;
}

void Photographer::add_loading(std::vector<Jobs::State>& states) const
{
    if (!document_ || !has_large()) return;
    const Shot& shot = *screenshots_.large();
    const Screen& screen = document_->screen;
    const char* const when = screen.complete() || screen.is_held() ? "" : ", when the picture in the window is sharp";
    states.push_back({.number = PICTURE_JOB, .what = shot.what() + when, .fraction = shot.progress()});
}

void Photographer::act(const Screenshot& action)
{
    if (!action.is_large) {
        document_->painted_at.reset();  // shows the probe's ball in full, as pictures drawn from the saved session do
        screenshots_.take();
        return say("The screenshot will be taken when the picture is sharp");
    }
    if (has_large()) decline(capitalised(IS_DRAWING_PICTURE));
    Session session = document_->saved_session();
    session.render.size = others_.pixels() * session.interaction.screenshot_scale;
    RenderOptions options;
    options.part_pixels = PART_PIXELS;
    screenshots_.take_large(stem(), renderer_, session, document_->camera, options,
                            texts_of_picture(session.render.size, false),
                            figure_of_picture(session.interaction.screenshot_scale));
    say_begun(sentence("A screenshot of ", session.render.size.x, " x ", session.render.size.y,
                       " pixels is made in the background"));
}

glm::uvec2 Photographer::pixels_of(const glm::ivec2& asked) const
{
    return asked.x > 0 && asked.y > 0 ? glm::uvec2(asked) : others_.pixels();
}

/// Returns what figures and movies show: all but the probe and the edges of the clip box.
Session Photographer::session_of_pictures(const glm::uvec2& pixels) const
{
    Session session = document_->saved_session();
    session.render.size = pixels;
    session.render.background.a = 1.0;
    session.view.cut_box = false;  // belongs to a tool, as the outline of the cutting plane does
    return session;
}

std::filesystem::path Photographer::project_of_pictures() const
{
    const bool has_project = document_->has_session_file() || document_->annotator.work().journal().bytes > 0;
    return has_project ? document_->session_path : std::filesystem::path();
}

Figure Photographer::drawn_elements(const DrawnElements& elements, const Session& session, const Camera& camera,
                                    std::vector<std::string>& left_out, FigureMemory* memory) const
{
    if (elements.is_empty() || !options_.draw_texts) return {};
    const VolumeInfo& volume = document_->volume();
    const std::vector<Pane> panes =
        panes_of(session.view, camera, session.render.size, volume, document_->probe_voxel());
    const shvr::Document& annotation = document_->annotator.document();
    const std::vector<uint8_t> groups = drawn_groups(session, annotation.mask.voxels_by_group(), annotation.trace);
    return figure_of(elements, {session, volume, panes, groups, memory}, options_.draw_texts, left_out);
}

void Photographer::act(const FigureTask& task)
{
    if (has_large()) decline(capitalised(IS_DRAWING_PICTURE));
    const std::filesystem::path path = task.is_copied ? path_for_clipboard() : task.path;
    Session session = session_of_pictures(pixels_of(task.pixels));
    if (task.is_transparent) session.render.background.a = 0.0;
    std::vector<std::string> left_out;
    Figure figure = drawn_elements(task.elements, session, document_->camera, left_out);
    PictureTexts texts =
        shvr::texts_of_picture(session, document_->camera, path, project_of_pictures(), PictureProbe::none);
    add_elements(texts, task.elements);
    if (task.dots_per_inch > 0.0) texts.emplace_back(PICTURE_DPI, digits_of(task.dots_per_inch));
    const std::string size = size_of_figure(session.render.size, task.dots_per_inch);
    PictureShot::Words words{.name = "figure",
                             .said = task.is_copied ? sentence("Copied the picture to the clipboard (", size, ")")
                                                    : sentence("Figure: ", path.string(), " (", size, ")")};
    for (const std::string& each : left_out) words.said += "; " + each;
    screenshots_.take(std::make_unique<PictureShot>(
        path, renderer_, session, document_->camera, RenderOptions{.part_pixels = PART_PIXELS}, texts,
        std::move(figure), words, task.is_copied ? PictureShot::Then(hand_over) : PictureShot::Then()));
    say_begun(sentence("A figure of ", size, " is drawn in the background"));
}

/// Draws while the trace, which the window's picture also shows, has the colours of these groups.
void Photographer::draw_with(const Groups& groups, const std::function<void()>& draw) const
{
    const TraceGraph& trace = document_->annotator.document().trace;
    const auto show = [&](const Groups& shown) { renderer_.scene().show_surfaces(document_->surfaces, trace, shown); };
    if (trace.nodes().empty() || groups == document_->session.groups) return draw();
    show(groups);
    try {
        draw();
    } catch (const DeviceLost&) {
        throw;  // the scene is lost, too
    } catch (...) {
        show(document_->session.groups);
        throw;
    }
    show(document_->session.groups);
}

void Photographer::act(const MovieTask& task)
{
    if (has_large()) decline(capitalised(IS_DRAWING_PICTURE));
    const Session session = session_of_pictures(pixels_of(task.pixels));
    std::vector<MovieView> views;
    for (const std::string& name : views_named_in(task.views))
        views.push_back({name, with_key_look(session, name), camera_named(session, name, document_->volume())});
    if (views.empty()) views.push_back({"the present view", session, document_->camera});
    const bool has_own_look = std::ranges::any_of(
        views, [&](const MovieView& view) { return key_look_of(view.session) != key_look_of(session); });
    Movie movie(std::move(views), task.turntable_degrees, task.frames, document_->volume());
    const DrawnElements& elements = task.elements;
    std::string said = sentence("A movie of ", counted(task.frames, "frame"), " is drawn in the background");
    std::vector<std::string> left_out;
    const Movie::Frame first = movie.frame(0);
    static_cast<void>(drawn_elements(elements, first.session, first.camera, left_out));
    for (const std::string& each : left_out) said += "; " + each;
    const auto memory = std::make_shared<FigureMemory>();
    MovieShot::Calls calls;
    calls.figure_of = [this, elements, memory](const Movie::Frame& frame) {
        std::vector<std::string> ignored;
        return drawn_elements(elements, frame.session, frame.camera, ignored, memory.get());
    };
    calls.texts_of = [this, elements](const Movie::Frame& frame, const std::filesystem::path& path) {
        PictureTexts kept =
            shvr::texts_of_picture(frame.session, frame.camera, path, project_of_pictures(), PictureProbe::none);
        add_elements(kept, elements);
        return kept;
    };
    calls.draw_with = [this](const Groups& groups, const std::function<void()>& draw) { draw_with(groups, draw); };
    screenshots_.take(std::make_unique<MovieShot>(task.path, std::move(movie), task.frames_per_second, renderer_,
                                                  RenderOptions{.part_pixels = PART_PIXELS}, std::move(calls),
                                                  has_own_look));
    say_begun(std::move(said), left_out.empty() ? Weight::done : Weight::warning);
}

/// Returns the marks to draw over a picture `scale` times as large as the window; empty if the user wants no marks.
Figure Photographer::figure_of_picture(uint32_t scale) const
{
    const Document& document = *document_;
    if (!document.session.interaction.screenshot_marks) return {};
    const std::vector<Pane> panes = panes_of(document.session.view, document.camera, others_.pixels() * scale,
                                             document.volume(), document.probe_voxel());
    return figure_of(model(), panes, units_ * scale, options_.draw_texts);
}

/// Makes the texts stored in a picture, such as its session. `shows_probe`: false for pictures larger than the window.
Screenshots::Texts Photographer::texts_of_picture(const glm::uvec2& pixels, bool shows_probe) const
{
    return [this, pixels, shows_probe](const std::filesystem::path& picture) {
        Session session = document_->saved_session();
        session.render.size = pixels;
        session.probe.preview = document_->previewer.shown() != nullptr;
        const bool has_project = document_->has_session_file() || document_->annotator.work().journal().bytes > 0;
        return shvr::texts_of_picture(std::move(session), document_->camera, picture,
                                      has_project ? document_->session_path : std::filesystem::path(),
                                      !shows_probe                                ? PictureProbe::none
                                      : document_->probe_look().ball_share == 1.0 ? PictureProbe::plain
                                                                                  : PictureProbe::point);
    };
}

}  // namespace shvr::ui
