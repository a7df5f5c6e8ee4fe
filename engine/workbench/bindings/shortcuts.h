#pragma once
// What keys, menu items, the palette and buttons of a stylus are bound to: an action with a name of its own and the
// arguments that fit the moment. Two sets of keys ship: today's conventions, and the thesis's appendix C as printed.
// Pure; any thread.

#include <array>
#include <span>
#include <string_view>

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/models/preferences.h"

namespace shvr::ui {

struct Shortcut {
    enum class Mode {
        tap,        ///< once for each press
        repeated,   ///< likewise, and again as the keyboard repeats it
        step,       ///< once for each press, by a fifth with Shift
        hold,       ///< goes on while held, slowly with Shift
        while_held  ///< begins when pressed and ends when released
    };
    const char* id = "";     ///< never changes: preferences refer to it
    const char* group = "";  ///< heading in menus, help and palette
    const char* name = "";   ///< "Undo"
    Mode mode = Mode::tap;
    /// `amount`: 1 for a tap, less with Shift, 5 a second while held; of `while_held` 1 at the beginning and 0 at the
    /// end.
    Action (*action)(const Model& model, double amount) = nullptr;
    /// Chords by KeySet, separated by spaces: "Ctrl+Y Ctrl+Shift+Z" (keymap.h).
    std::array<const char*, 2> keys{"", ""};
    bool is_by_position = false;  ///< its letter means the key at that place of an American keyboard

    bool is_slowed() const { return mode == Mode::step || mode == Mode::hold; }
};

/// Shortcuts of a group stand together.
std::span<const Shortcut> shortcuts();
/// Null where there is none.
const Shortcut* shortcut_named(std::string_view id);
/// Why it would do nothing now; empty: nothing speaks against it.
std::string why_not(const Model& model, const Shortcut& shortcut);

}  // namespace shvr::ui
