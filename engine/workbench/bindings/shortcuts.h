#pragma once
// Shortcuts for keys, menu items, the palette and stylus buttons. A shortcut is a named action whose arguments depend
// on the current state. Two sets of keys ship: today's conventions, and those of the thesis as printed in its appendix
// C. Pure; any thread.

#include <array>
#include <span>
#include <string_view>

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/models/preferences.h"

namespace shvr::ui {

struct Shortcut {
    enum class Mode {
        tap,        ///< once per press
        repeated,   ///< acts once per press, and again at the keyboard's auto-repeat
        step,       ///< acts once per press; with Shift, by a fifth of the usual amount
        hold,       ///< continuous while held; slower with Shift
        while_held  ///< starts when pressed and ends when released
    };
    const char* id = "";     ///< never changes: preferences refer to it
    const char* group = "";  ///< heading in menus, help and palette
    const char* name = "";   ///< "Undo"
    Mode mode = Mode::tap;
    /// `amount`: 1 for a tap, less with Shift; 5 per second while a key is held. In mode `while_held`: 1 at the start
    /// and 0 at the end.
    Action (*action)(const Model& model, double amount) = nullptr;
    /// Default chords in each KeySet, separated by spaces: "Ctrl+Y Ctrl+Shift+Z" (keymap.h).
    std::array<const char*, 2> keys{"", ""};
    bool is_by_position = false;  ///< the letter means the key at that letter's position on an American keyboard

    bool is_slowed() const { return mode == Mode::step || mode == Mode::hold; }
};

/// Returns all shortcuts; shortcuts of the same group are adjacent.
std::span<const Shortcut> shortcuts();
/// Returns null if there is none.
const Shortcut* shortcut_named(std::string_view id);
/// Returns why the shortcut is unavailable now; empty if it is available.
std::string why_not(const Model& model, const Shortcut& shortcut);

}  // namespace shvr::ui
