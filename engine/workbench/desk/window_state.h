#pragma once
// State of the window that is not part of the picture: dialogs, lists, full screen, and the window of passes.

#include "engine/workbench/desk/preference_keeper.h"
#include "engine/workbench/desk/service.h"
#include "engine/workbench/lists/pass_log.h"

namespace shvr::ui {

class WindowState : public Service {
public:
    WindowState(Desk& desk, PreferenceKeeper& keeper) : Service(desk), keeper_(keeper) {}
    void act(const AskOpen& action);
    void act(const ShowHelp& action);
    void act(const ShowManual& action);
    void act(const ShowMessages& action);
    void act(const ShowPasses& action);
    void act(const SavePasses& action);
    void act(const ComparePasses& action);
    void act(const ShowPalette& action);
    void act(const ShowPreferences& action);
    void act(const ShowDialog& action);
    void act(const FocusOn& action);
    void act(const ShowFullScreen& action);

    bool is_full_screen() const { return is_full_screen_; }
    /// Returns the part of the window that should get the keyboard focus, and clears the request; empty: no request.
    std::string take_focus() { return std::exchange(focus_, {}); }
    /// Returns the page that the browser should open, and clears the request; empty: no request.
    std::filesystem::path take_page() { return std::exchange(page_, {}); }
    WindowModel model() const;

private:
    PreferenceKeeper& keeper_;
    bool shows_help_ = false, shows_passes_ = false, shows_palette_ = false, is_full_screen_ = false;
    bool asks_what_to_open_ = false, shows_preferences_ = false;
    Dialog dialog_ = Dialog::none;
    std::string operation_ = "grow";  ///< id of the operation that the window of operations on groups shows
    std::string focus_;
    std::filesystem::path page_;
    std::optional<PassRun> compared_passes_;
};

}  // namespace shvr::ui
