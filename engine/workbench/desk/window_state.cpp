#include "engine/workbench/desk/window_state.h"

#include "engine/base/assets.h"
#include "engine/workbench/desk/declined.h"

namespace shvr::ui {

void WindowState::act(const AskOpen& action)
{
    asks_what_to_open_ = action.on;
}

void WindowState::act(const ShowHelp& action)
{
    shows_help_ = action.on;
    if (!action.on) keeper_.await_no_key();
}

void WindowState::act(const ShowManual&)
{
    const std::filesystem::path page = manual_page();
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(page, unknown))
        return say(sentence("The user manual is not installed; expected it at ", page.string(),
                            ", where the packages of SHVR put it"),
                   Weight::warning);
    page_ = page;
    say("The user manual: " + page.string());
}

void WindowState::act(const ShowMessages& action)
{
    desk_.are_messages_shown = action.on;
    desk_.messages.note_read();
}

void WindowState::act(const ShowPalette& action)
{
    shows_palette_ = action.on;
}

void WindowState::act(const ShowPreferences& action)
{
    shows_preferences_ = action.on;
}

void WindowState::act(const ShowDialog& action)
{
    if (needs_document(action.dialog) && !document_) decline("Nothing is open");
    dialog_ = action.dialog;
    if (!action.operation.empty()) operation_ = action.operation;
}

void WindowState::act(const FocusOn& action)
{
    focus_ = action.what;
}

void WindowState::act(const ShowFullScreen& action)
{
    is_full_screen_ = action.on;
}

void WindowState::act(const ShowPasses& action)
{
    shows_passes_ = action.on;
}

void WindowState::act(const SavePasses& action)
{
    save_pass_run(action.path, document_->screen.pass_times());
    say("GPU passes are in " + action.path.string());
}

void WindowState::act(const ComparePasses& action)
{
    if (action.path.empty()) {
        compared_passes_.reset();
        return say("GPU passes are compared with nothing");
    }
    compared_passes_ = read_pass_run(action.path);
    say(sentence("GPU passes are compared with ", action.path.string(), ", which has ", compared_passes_->passes.size(),
                 " of them"));
}

WindowModel WindowState::model() const
{
    WindowModel shown{.shows_help = shows_help_,
                      .shows_messages = desk_.are_messages_shown,
                      .shows_passes = shows_passes_,
                      .shows_palette = shows_palette_,
                      .is_full_screen = is_full_screen_,
                      .asks_what_to_open = asks_what_to_open_,
                      .shows_preferences = shows_preferences_,
                      .dialog = dialog_,
                      .operation = operation_,
                      .gpu_name = renderer_.device().traits().name};
    if (!document_) return shown;
    shown.device_bytes = renderer_.memory().device_bytes();
    shown.device_budget = renderer_.memory().device_budget();
    if (shows_passes_) shown.bytes_by_name = renderer_.memory().bytes_by_name();
    if (compared_passes_) shown.compared_passes = &*compared_passes_;
    return shown;
}

}  // namespace shvr::ui
