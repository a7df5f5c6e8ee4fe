#pragma once
// Actions on the window, on keys and on preferences.

#include "engine/annotation/operations/operations.h"
#include "engine/workbench/actions/action_row.h"
#include "engine/workbench/models/dialogs.h"

namespace shvr::ui {

class PreferenceKeeper;
class Saver;
class Viewer;
class WindowState;

struct AskOpen {  ///< shows or hides the file chooser
    bool on = true;
};

/// Selects one of the two sets of keys (shortcuts.h).
struct ChooseKeys {
    std::string set;
};

/// Assigns keys to the shortcut with this id. `keys`: chords separated by spaces; empty: the shortcut has no keys.
struct BindKeys {
    std::string shortcut, keys;
};

/// Sets the size of the picture. Pixels of panes refer to this size.
struct Resize {
    glm::uvec2 pixels{0};
};

/// Waits for a key press, and binds that key to the shortcut; Escape keeps the old binding, Delete removes the
/// shortcut's keys. An empty id ends the waiting.
struct AwaitKey {
    std::string shortcut;
};

struct ShowHelp {
    bool on = true;
};

struct ShowManual {};  ///< opens the user manual in the browser

/// Shows the list of all messages with their severity; while it is shown, messages count as read.
struct ShowMessages {
    bool on = true;
};

/// Shows the GPU time of each pass of a picture.
struct ShowPasses {
    bool on = true;
};

/// Saves the GPU times of the current picture's passes to a file, for later comparison.
struct SavePasses {
    std::filesystem::path path;
};

/// Compares pass times with a saved file or with output of `shvr profile --json`; an empty path ends the comparison.
struct ComparePasses {
    std::filesystem::path path;
};

/// Shows the palette: a text box that searches all shortcuts, actions and settings.
struct ShowPalette {
    bool on = true;
};

/// Changes preferences (preferences.h) by a JSON merge patch, such as {"theme": "light"}; null restores a default.
struct Prefer {
    std::string patch;
};

struct ShowPreferences {
    bool on = true;
};

/// Moves the keyboard focus to the panels or to the menu, until Escape or a click.
struct FocusOn {
    std::string what = "panels";  ///< or "menu"
};

/// Shows a dialog that asks for files and options, instead of the one that is shown; none closes it.
struct ShowDialog {
    Dialog dialog = Dialog::none;
    std::string operation{};  ///< id of the operation on groups to choose in its window; empty: the one chosen there
};

struct ShowFullScreen {
    bool on = true;
};

struct Quit {
    bool saves = true;  ///< false: reverts the work to the last save, as one step, which can be undone
};

/// Takes back the wish to close the window, while that waits until files are written.
struct StayOpen {};

inline constexpr const char* WINDOW_GROUP = "Window";

inline constexpr auto WINDOW_ACTIONS = std::tuple{
    row<AskOpen, WindowState>({"ask_open", "Open...", WINDOW_GROUP,
                               "shows or hides the file chooser, which asks what to open", Needs::nothing},
                              [](auto& f, AskOpen& a) { f.flag("on", a.on, {}); }),
    row<ChooseKeys, PreferenceKeeper>(
        {"choose_keys", "Choose the keys", WINDOW_GROUP, "selects one of the two supplied key sets", Needs::nothing},
        [](auto& f, ChooseKeys& a) { f.text("set", a.set, {.is_required = true}); }),
    row<BindKeys, PreferenceKeeper>(
        {"bind_keys", "Other keys", WINDOW_GROUP, "binds a shortcut to keys other than its defaults", Needs::nothing},
        [](auto& f, BindKeys& a) {
            f.text("shortcut", a.shortcut, {.is_required = true});
            f.text("keys", a.keys, {});
        }),
    row<Resize, Viewer>(
        {"resize", "Resize", WINDOW_GROUP, "sets the picture size in pixels, across and down", Needs::nothing},
        [](auto& f, Resize& a) {
            std::vector<int64_t> pixels{a.pixels.x, a.pixels.y};
            f.wholes("pixels", pixels, 0, 65536, {.is_required = true});
            a.pixels = {pixels[0], pixels[1]};
        }),
    row<AwaitKey, PreferenceKeeper>({"await_key", "Press a key for it", WINDOW_GROUP,
                                     "binds a shortcut to the next key that is pressed", Needs::nothing},
                                    [](auto& f, AwaitKey& a) { f.text("shortcut", a.shortcut, {}); }),
    row<ShowHelp, WindowState>(
        {"show_help", "Keys and mouse", WINDOW_GROUP, "shows or hides the list of keys", Needs::nothing},
        [](auto& f, ShowHelp& a) { f.flag("on", a.on, {}); }),
    row<ShowManual, WindowState>(
        {"show_manual", "User manual", WINDOW_GROUP, "opens the user manual in the browser", Needs::nothing},
        NO_FIELDS),
    row<ShowMessages, WindowState>({"show_messages", "Messages", WINDOW_GROUP,
                                    "shows or hides all messages, and marks them as read", Needs::nothing},
                                   [](auto& f, ShowMessages& a) { f.flag("on", a.on, {}); }),
    row<ShowPasses, WindowState>(
        {"show_passes", "GPU passes", WINDOW_GROUP, "shows or hides the device time of each step of a picture"},
        [](auto& f, ShowPasses& a) { f.flag("on", a.on, {}); }),
    row<SavePasses, WindowState>(
        {"save_passes", "Save GPU passes", WINDOW_GROUP, "writes the times of the present picture's steps to a file"},
        [](auto& f, SavePasses& a) { f.path("path", a.path, {.is_required = true}); }),
    row<ComparePasses, WindowState>(
        {"compare_passes", "Compare GPU passes", WINDOW_GROUP,
         "compares with a saved file, or one of shvr profile --json"},
        [](auto& f, ComparePasses& a) { f.path("path", a.path, {}); },
        [](const auto& model, const ComparePasses& action) -> std::string {
            return action.path.empty() && !model.compared_passes ? "they are compared with nothing" : "";
        }),
    row<ShowPalette, WindowState>({"show_palette", "Find anything", WINDOW_GROUP,
                                   "shows or hides a box that finds shortcuts, actions and settings", Needs::nothing},
                                  [](auto& f, ShowPalette& a) { f.flag("on", a.on, {}); }),
    row<Prefer, PreferenceKeeper>({"prefer", "Change preferences", WINDOW_GROUP,
                                   "sets preferences for all scans; null restores the default", Needs::nothing},
                                  [](auto& f, Prefer& a) {
                                      const auto read = [&](const JsonNode& node) {
                                          if (!node.is_object())
                                              node.refuse("an object such as {\"theme\": \"light\"}");
                                          a.patch = node.dump();
                                      };
                                      f.other("values", read, [&] { return std::optional(a.patch); },
                                              {.is_required = true});
                                  }),
    row<ShowPreferences, WindowState>(
        {"show_preferences", "Preferences", WINDOW_GROUP, "shows or hides theme, sizes and keys", Needs::nothing},
        [](auto& f, ShowPreferences& a) { f.flag("on", a.on, {}); }),
    row<ShowDialog, WindowState>(
        {"show_dialog", "Show a dialog", WINDOW_GROUP, "shows a dialog that asks for files and options, or closes it",
         Needs::nothing},
        [](auto& f, ShowDialog& a) {
            f.choice("dialog", a.dialog, {.meaning = "which one", .is_required = true});
            f.text("operation", a.operation, {"the operation on groups that its window shows"});
            const auto has_id = [&](const OperationRow& each) { return each.id == a.operation; };
            f.check("operation", a.operation.empty() || std::ranges::any_of(OPERATION_ROWS, has_id),
                    "the id of an operation on groups, such as \"grow\"");
        },
        [](const auto& model, const ShowDialog& action) -> std::string {
            if (!needs_document(action.dialog)) return {};
            if (!model.is_open) return "nothing is open";
            const bool is_saved = action.dialog == Dialog::save_as || action.dialog == Dialog::spacing;
            return is_saved ? why_not_edited(model) : std::string();
        }),
    row<FocusOn, WindowState>({"focus", "Use panels by keyboard", WINDOW_GROUP,
                               "gives the keyboard to the panels or to the menu", Needs::nothing},
                              [](auto& f, FocusOn& a) {
                                  f.choice("what", a.what, {"panels", "menu"}, {});
                              }),
    row<ShowFullScreen, WindowState>(
        {"full_screen", "Full screen", WINDOW_GROUP, "switches full screen on or off", Needs::nothing},
        [](auto& f, ShowFullScreen& a) { f.flag("on", a.on, {}); }),
    row<Quit, Saver>({"quit", "Quit", WINDOW_GROUP,
                      "saves the work, or returns to the last save, and closes the window", Needs::nothing},
                     [](auto& f, Quit& a) { f.flag("saves", a.saves, {}); }),
    row<StayOpen, Saver>({"stay_open", "Stay open", WINDOW_GROUP,
                          "keeps the window open, while closing it waits until files are written", Needs::nothing},
                         NO_FIELDS, [](const auto& model, const StayOpen&) -> std::string {
                             return model.waits_to_close ? "" : "the window is not waiting to close";
                         })};

}  // namespace shvr::ui
