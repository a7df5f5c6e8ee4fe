// Actions on the work: undo and redo, saving, pictures, opening another scan.

#include <algorithm>
#include <utility>

#include "engine/session/picture_session.h"
#include "ui/workbench/workbench.h"

namespace shvr::ui {

template <class Way>
void Workbench::step(int count, const char* done, const char* nothing, Way way)
{
    record_settings();
    std::string last;
    int steps = 0;
    for (; steps < count; ++steps) {
        const Command* const command = way(document_->annotator);
        if (!command) break;
        show_changes(*command);
        last = command->label;
    }
    if (steps == 0 && document_->annotator.stroke_is_running()) fail("A stroke is being painted");
    if (steps == 0) return say(nothing);
    say(steps == 1 ? sentence(done, ": ", last) : sentence(done, ": ", steps, " steps, the last: ", last));
}

/// Whether undo would take back another step than what a person did last: a stroke that changed nothing is none.
/// Asked once after such a stroke. Scripts count steps.
bool Workbench::follows_empty_stroke()
{
    record_settings();
    const size_t steps = document_->annotator.history().undoable();
    return std::exchange(steps_at_empty_stroke_, {}) == steps && steps > 0 && !document_->is_script();
}

void Workbench::act(const UndoOp& action)
{
    if (follows_empty_stroke() && action.count == 1) {
        const History& history = document_->annotator.history();
        say(sentence("The last stroke changed nothing, and nothing is undone; undo once more takes back: ",
                     history.label_of(history.undoable() - 1)));
        return log_instead({Set{"{}"}});
    }
    step(action.count, "Undone", "Nothing to undo", [](Annotator& annotator) { return annotator.undo(); });
}

void Workbench::act(const RedoOp& action)
{
    steps_at_empty_stroke_.reset();
    step(action.count, "Redone", "Nothing to redo", [](Annotator& annotator) { return annotator.redo(); });
}

void Workbench::act(const RevertOp&)
{
    record_settings();
    const Command* const command = document_->annotator.revert();
    if (!command && document_->annotator.stroke_is_running()) fail("A stroke is being painted");
    if (!command) return say("Nothing has changed since the last save");
    show_changes(*command);
    say("Reverted to the last save; undo takes that back");
}

void Workbench::act(const Screenshot& action)
{
    if (!action.is_large) {
        document_->painted_at.reset();  // a picture is drawn again from its session, which knows no smaller ball
        screenshots_.take();
        return say("The screenshot will be taken when the picture is sharp");
    }
    Session session = document_->saved_session();
    session.render.size = pixels_ * session.interaction.screenshot_scale;
    RenderOptions options;
    options.part_pixels = 96;  // bounds the delay when the user resumes
    screenshots_.take_large(screenshot_stem(), renderer_, session, document_->camera, options,
                            texts_of_picture(session.render.size, false),
                            figure_of_picture(session.interaction.screenshot_scale));
    say(sentence("A screenshot of ", session.render.size.x, " x ", session.render.size.y,
                 " pixels is made in the background"));
}

/// Of a picture so many times as large as the window; empty where none is wanted.
Figure Workbench::figure_of_picture(uint32_t scale) const
{
    const Document& document = *document_;
    if (!document.session.interaction.screenshot_marks) return {};
    const std::vector<Pane> panes =
        panes_of(document.session.view, document.camera, pixels_ * scale, document.volume(), document.probe_voxel());
    return figure_of(model(), panes, units_ * scale, options_.draw_texts);
}

/// The session in a picture is of that size; a picture larger than the window shows no probe.
Screenshots::Texts Workbench::texts_of_picture(const glm::uvec2& pixels, bool shows_probe) const
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

void Workbench::act(const ChooseBelief& action)
{
    std::string said;
    for (const Notice& notice : document_->annotator.choose(action.takes_files ? Belief::files : Belief::journal))
        said += (said.empty() ? "" : "; ") + notice.text;
    document_->drags_node = false;
    look_again();
    say(said);
}

}  // namespace shvr::ui
