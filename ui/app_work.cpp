// Actions on the work: undo and redo, saving, pictures, opening another scan.

#include <imgui/imgui.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "ui/app.h"

namespace shvr::ui {

void App::apply(const Undo&)
{
    record_settings();
    const Command* command = document_->annotator.undo();
    if (!command) return say("Nothing to undo");
    show_changes(*command);
    say("Undone: " + command->label);
}

void App::apply(const Redo&)
{
    record_settings();
    const Command* command = document_->annotator.redo();
    if (!command) return say("Nothing to redo");
    show_changes(*command);
    say("Redone: " + command->label);
}

/// Updates the window's data about the trace; the annotator passes changes to the scene itself.
void App::show_changes(const Command& command)
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

void App::apply(const Save&)
{
    save();
}

void App::apply(const Screenshot& action)
{
    if (!action.is_large) {
        screenshots_.take();
        return say("The screenshot will be taken when the picture is sharp");
    }
    Session session = document_->saved_session();
    session.render.size = viewport_.pixels() * session.interaction.screenshot_scale;
    RenderOptions options;
    options.part_pixels = 96;  // bounds the delay when the user resumes
    screenshots_.take_large(screenshot_stem(), *renderer_, session, document_->camera, options);
    say(sentence("A screenshot of ", session.render.size.x, " x ", session.render.size.y,
                 " pixels is made in the background"));
}

void App::apply(const SetInteraction& action)
{
    document_->session.interaction = action.interaction;
    look_again();
}

void App::apply(const Open& action)
{
    if (document_) save_before_leaving();
    open(action.path, {});
}

void App::apply(const ChooseBelief& action)
{
    std::string said;
    for (const Notice& notice : document_->annotator.choose(action.takes_files ? Belief::files : Belief::journal))
        said += (said.empty() ? "" : "; ") + notice.text;
    document_->drags_node = false;
    look_again();
    say(said);
}

void App::apply(const WorkOnCopy&)
{
    const std::filesystem::path copy = document_->save_copy();
    open(copy, {});
}

/// Saves all work as the Save command does; if the user only looked around, saves the view silently. A window that only
/// looks saves nothing, as it says; and while it is asked what to believe, annotation stays as the journal has it.
void App::save_before_leaving()
{
    if (document_->only_looks()) return;
    if (!document_->annotator.work().disputes().empty()) return document_->save_settings();
    if (document_->is_saved() && !document_->annotator.stroke_is_running()) return document_->keep_view();
    save();
}

/// Makes a step of the history of what was set, once the hand has let go: one drag is one step.
void App::follow_settings()
{
    const bool is_being_set = std::exchange(was_set_in_this_turn_, false) || ImGui::IsAnyMouseDown();
    if (!settings_to_record_ || is_being_set || document_->annotator.stroke_is_running()) return;
    record_settings();
}

/// Of what follows, undo is to take back that first.
void App::record_settings()
{
    if (document_->annotator.stroke_is_running()) return;
    settings_to_record_ = false;
    document_->record_settings();
}

void App::note_edit()
{
    document_->note_edit();
    settings_to_record_ = was_set_in_this_turn_ = true;
    was_asked_to_close_ = false;
}

/// A save includes all that the stroke has covered, so this waits for its bricks. Returns why part of it was not
/// painted; empty if all was.
std::string App::finish_stroke()
{
    constexpr double PATIENCE_S = 20.0;
    constexpr std::chrono::milliseconds TURN(1);
    Annotator& annotator = document_->annotator;
    extend_stroke();
    if (annotator.stroke_is_open()) annotator.end_stroke();
    double last_progress_s = window_.now_s();
    uint64_t uploads = 0;
    try {
        while (annotator.stroke_is_running()) {
            const bool has_painted = annotator.advance().has_value();
            renderer_->scene().advance();
            const uint64_t uploads_before =
                std::exchange(uploads, renderer_->volume().counts().value_or(DeviceVolume::Counts{}).uploads);
            if (has_painted || uploads != uploads_before) last_progress_s = window_.now_s();
            if (window_.now_s() - last_progress_s > PATIENCE_S) {
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

void App::save()
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

void App::apply(const ShowHelp& action)
{
    shows_help_ = action.on;
}

void App::apply(const Quit&)
{
    window_.close();
}

}  // namespace shvr::ui
