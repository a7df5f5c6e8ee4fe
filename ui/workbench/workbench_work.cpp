// Actions on the work: undo and redo, saving, pictures, opening another scan.

#include <algorithm>
#include <chrono>
#include <thread>

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
    if (steps == 0) fail(document_->annotator.stroke_is_running() ? "A stroke is being painted" : nothing);
    say(steps == 1 ? sentence(done, ": ", last) : sentence(done, ": ", steps, " steps, the last: ", last));
}

void Workbench::act(const UndoOp& action)
{
    step(action.count, "Undone", "Nothing to undo", [](Annotator& annotator) { return annotator.undo(); });
}

void Workbench::act(const RedoOp& action)
{
    step(action.count, "Redone", "Nothing to redo", [](Annotator& annotator) { return annotator.redo(); });
}

/// Updates the window's data about the trace; the annotator passes changes to the scene itself.
void Workbench::show_changes(const Command& command)
{
    Document& document = *document_;
    const bool is_traced = std::ranges::any_of(
        command.changes, [](const Change& change) { return std::holds_alternative<TraceChange>(change); });
    if (is_traced) document.drags_node = false;
    const bool is_set = std::ranges::any_of(
        command.changes, [](const Change& change) { return std::holds_alternative<SettingChange>(change); });
    if (!is_set) return;
    document.take_settings();
    look_again();
}

void Workbench::act(const SaveOp&)
{
    save();
}

void Workbench::act(const RevertOp&)
{
    record_settings();
    const Command* const command = document_->annotator.revert();
    if (!command)
        fail(document_->annotator.stroke_is_running() ? "A stroke is being painted"
                                                      : "Nothing has changed since the last save");
    show_changes(*command);
    say("Reverted to the last save; undo takes that back");
}

void Workbench::act(const SaveAs& action)
{
    const std::string unpainted = finish_stroke();
    record_settings();
    std::string kept;
    for (const Notice& notice : document_->save_as(action.path)) kept += "; " + notice.text;
    say("Saved as " + document_->session_path.string() +
        (unpainted.empty() ? "" : "; the rest of the stroke was not painted: " + unpainted) + kept);
    Preferences preferences = preferences_;
    preferences.note_opened(document_->session_path);
    prefer(std::move(preferences));
}

void Workbench::act(const CopySession& action)
{
    record_settings();
    say("Copied to " + document_->save_copy(action.path).string() + "; this window goes on with " +
        document_->session_path.string());
}

void Workbench::act(const Screenshot& action)
{
    if (!action.is_large) {
        screenshots_.take();
        return say("The screenshot will be taken when the picture is sharp");
    }
    Session session = document_->saved_session();
    session.render.size = pixels_ * session.interaction.screenshot_scale;
    RenderOptions options;
    options.part_pixels = 96;  // bounds the delay when the user resumes
    screenshots_.take_large(screenshot_stem(), renderer_, session, document_->camera, options);
    say(sentence("A screenshot of ", session.render.size.x, " x ", session.render.size.y,
                 " pixels is made in the background"));
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

void Workbench::act(const WorkOnCopy&)
{
    const std::filesystem::path copy = document_->save_copy();
    open(copy, {});
}

/// Saves all work as the Save command does; if the user only looked around, saves the view silently. A window that only
/// looks saves nothing, as it says; and while it is asked what to believe, annotation stays as the journal has it.
void Workbench::save_before_leaving()
{
    if (document_->only_looks()) return;
    if (!document_->annotator.work().disputes().empty()) return document_->save_settings();
    if (document_->is_saved() && !document_->annotator.stroke_is_running()) return document_->keep_view();
    save();
}

/// A save includes all that the stroke has covered, so this waits for its bricks. Returns why part of it was not
/// painted; empty if all was.
std::string Workbench::finish_stroke()
{
    constexpr double PATIENCE_S = 20.0;
    constexpr std::chrono::milliseconds TURN(1);
    Annotator& annotator = document_->annotator;
    extend_stroke();
    if (annotator.stroke_is_open()) annotator.end_stroke();
    double last_progress_s = options_.now_s();
    uint64_t uploads = 0;
    try {
        while (annotator.stroke_is_running()) {
            const bool has_painted = annotator.advance().has_value();
            renderer_.scene().advance();
            const uint64_t uploads_before =
                std::exchange(uploads, renderer_.volume().counts().value_or(DeviceVolume::Counts{}).uploads);
            if (has_painted || uploads != uploads_before) last_progress_s = options_.now_s();
            if (options_.now_s() - last_progress_s > PATIENCE_S) {
                annotator.drop_stroke();
                return sentence("its bricks did not arrive within ", PATIENCE_S, " s");
            }
            std::this_thread::sleep_for(TURN);
        }
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

void Workbench::save()
{
    const std::string unpainted = finish_stroke();
    record_settings();
    std::string kept;
    for (const Notice& notice : document_->save()) kept += "; " + notice.text;
    const std::filesystem::path& trace = document_->session.trace_path;
    const bool has_trace = !trace.empty() && std::filesystem::exists(trace);
    say("Saved " + document_->session.mask_path.string() + (has_trace ? ", " + trace.string() : std::string()) +
        " and " + document_->session_path.string() +
        (unpainted.empty() ? "" : "; the rest of the stroke was not painted: " + unpainted) + kept);
}

}  // namespace shvr::ui
