#pragma once
// Converts key events to actions with the keymap (engine/workbench/bindings/keymap.h). Letters and symbols depend on
// the user's layout; keys that steer like a joystick have the same position on every keyboard. Main thread.

#include <vector>

#include "engine/workbench/bindings/keymap.h"
#include "ui/window.h"

namespace shvr::ui {

class Keyboard {
public:
    /// Handles a press or a release. `ui_has_keys`: the interface takes the keys, so presses are ignored here.
    void handle(const KeyEvent& event, const Model& model, bool ui_has_keys, Actions& actions);
    /// Adds the actions of held keys for the `seconds` since the last call. Keys for which `is_down` returns false are
    /// released.
    void hold(double seconds, int mods, const std::function<bool(int key)>& is_down, const Model& model,
              Actions& actions);

private:
    struct Held {
        KeyEvent pressed;
        const Shortcut* lasting = nullptr;  ///< the shortcut whose action lasts until the key is released
    };
    static void release(const Held& held, const Model& model, Actions& actions);
    std::vector<Held> held_;
};

/// Returns whether Dear ImGui navigates with this key: arrows, Tab, Space, Enter and Escape, without Ctrl and Alt.
bool moves_in_panels(const KeyEvent& event);
/// Returns whether a press of this key over the picture would make Dear ImGui move the focus into a panel (only Tab).
bool moves_focus(const KeyEvent& event);
/// Returns whether the key enters a character, without Ctrl and Alt.
bool types_text(const KeyEvent& event);
/// Returns whether the key is Shift, Ctrl, Alt or Super.
bool is_modifier(const KeyEvent& event);
/// Returns whether the key returns the keyboard from the panels to the picture.
bool leaves_panels(const KeyEvent& event);

/// Returns the GLFW_MOD_* bits of the modifier keys that are held.
int mods_held(const Window& window);

}  // namespace shvr::ui
