#pragma once
// Keys: one table of key, modifiers, what it does and in which words, from which both the keyboard and the help window
// are served. Codes are GLFW's. The letters are those of the thesis's appendix C.

#include <span>
#include <string>

#include "ui/action.h"
#include "ui/model.h"
#include "ui/window.h"

namespace shvr::ui {

struct KeyBinding {
    int key = 0;
    int mods = 0;            ///< GLFW_MOD_CONTROL, _ALT, _SHIFT, exactly these; shift is free where `is_slowed`
    bool is_slowed = false;  ///< shift makes it a fifth
    bool repeats = false;    ///< goes on while the key is held
    const char* group = "";  ///< heading in the help window
    const char* name = "";   ///< "Undo"
    Action (*action)(const Model& model, double amount) = nullptr;  ///< amount: 1 for a tap; seconds * 5 while held
};

std::span<const KeyBinding> key_bindings();
/// "Ctrl + Shift + Z"
std::string name_of(const KeyBinding& binding);

/// Adds what a key that went down means.
void key_pressed(const KeyEvent& event, const Model& model, Actions& actions);
/// Adds what the keys that are held mean, `seconds` after the last call.
void keys_held(const Window& window, double seconds, const Model& model, Actions& actions);

}  // namespace shvr::ui
