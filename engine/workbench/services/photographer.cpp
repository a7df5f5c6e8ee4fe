#include "engine/workbench/services/photographer.h"

#include <cstdlib>

#include "engine/session/picture_session.h"

namespace shvr::ui {

namespace {

constexpr Jobs::Number NUMBER_OF_LARGE = (Jobs::Number{1} << 49) + 1;  // no job has it

}  // namespace

Photographer::Photographer(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}

void Photographer::advance()
{
    attempt(photographing_, [this] { follow_screenshots(); });
}

void Photographer::drop_large(const char* by)
{
    if (!screenshots_.has_large()) return;
    screenshots_.drop_large();
    say(sentence("The large screenshot was cancelled by ", by), Weight::warning);
}

void Photographer::follow_screenshots()
{
    if (document_->annotator.stroke_is_running()) drop_large("painting");  // only some parts would show it
    const Screenshots::Turn turn =
        screenshots_.advance(document_->screen, stem(), is_still_, texts_of_picture(others_.pixels(), true),
                             [this] { return figure_of_picture(1); });
    if (!turn.said.empty()) say(turn.said);
    if (!turn.progress.empty()) desk_.messages.amend(options_.now_s(), turn.progress);
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
    if (number != NUMBER_OF_LARGE || !has_large()) return false;
    screenshots_.drop_large();
    say("Cancelled: the large screenshot");
    return true;
}

void Photographer::add_loading(std::vector<Jobs::State>& states) const
{
    if (!document_ || !has_large()) return;
    states.push_back({.number = NUMBER_OF_LARGE,
                      .what = "drawing " + short_name(screenshots_.large_path()),
                      .fraction = screenshots_.progress()});
}

void Photographer::act(const Screenshot& action)
{
    if (!action.is_large) {
        document_->painted_at.reset();  // shows the probe's ball in full, as pictures drawn from the saved session do
        screenshots_.take();
        return say("The screenshot will be taken when the picture is sharp");
    }
    Session session = document_->saved_session();
    session.render.size = others_.pixels() * session.interaction.screenshot_scale;
    RenderOptions options;
    options.part_pixels = 96;  // bounds the delay when the user resumes
    screenshots_.take_large(stem(), renderer_, session, document_->camera, options,
                            texts_of_picture(session.render.size, false),
                            figure_of_picture(session.interaction.screenshot_scale));
    say(sentence("A screenshot of ", session.render.size.x, " x ", session.render.size.y,
                 " pixels is made in the background"));
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
        const bool has_project = document_->has_session_file() || document_->annotator.work().journal().bytes > 0;
        return shvr::texts_of_picture(std::move(session), document_->camera, picture,
                                      has_project ? document_->session_path : std::filesystem::path(),
                                      shows_probe ? PictureProbe::plain : PictureProbe::none);
    };
}

}  // namespace shvr::ui
