#pragma once
// Keys: one table of keys, modifiers, actions and their names; keyboard, menus and help window all use it. Codes are
// GLFW's. The letters are those of the thesis's appendix C.

#include <span>
#include <string>

#include "ui/action.h"
#include "ui/model.h"
#include "ui/window.h"

namespace shvr::ui {

struct KeyBinding {
    int key = 0;
    int mods = 0;            ///< GLFW_MOD_CONTROL, _ALT, _SHIFT, must match exactly; shift is free if `is_slowed`
    bool is_slowed = false;  ///< shift reduces the amount to a fifth
    bool repeats = false;    ///< continues while the key is held
    const char* group = "";  ///< heading in the help window
    const char* name = "";   ///< "Undo"
    Action (*action)(const Model& model, double amount) = nullptr;  ///< amount: 1 for a tap; seconds * 5 while held
};

std::span<const KeyBinding> key_bindings();
/// "Ctrl + Shift + Z"
std::string name_of(const KeyBinding& binding);

/// Adds the actions of a key press.
void key_pressed(const KeyEvent& event, const Model& model, Actions& actions);
/// Adds the actions of the keys held down, `seconds` after the last call.
void keys_held(const Window& window, double seconds, const Model& model, Actions& actions);

}  // namespace shvr::ui
