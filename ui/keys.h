#pragma once
// Converts key events to actions with the keymap (engine/workbench/bindings/keymap.h). Letters and symbols are taken
// from the user's layout; keys that steer like a joystick have the same place on every keyboard. Main thread.

#include <vector>

#include "engine/workbench/bindings/keymap.h"
#include "ui/window.h"

namespace shvr::ui {

class Keyboard {
public:
    /// Handles a press or a release. `ui_has_keys`: text is being typed, so presses are ignored here.
    void handle(const KeyEvent& event, const Model& model, bool ui_has_keys, Actions& actions);
    /// Adds the actions of held keys, `seconds` after the last call. Keys that `is_down` no longer reports are
    /// released.
    void hold(double seconds, int mods, const std::function<bool(int key)>& is_down, const Model& model,
              Actions& actions);

private:
    struct Held {
        KeyEvent pressed;
        const Shortcut* lasting = nullptr;  ///< the shortcut whose action ends when the key is released
    };
    static void release(const Held& held, const Model& model, Actions& actions);
    std::vector<Held> held_;
};

/// Returns whether Dear ImGui navigates with this key: arrows, Tab, Space, Enter and Escape, without Ctrl and Alt.
bool moves_in_panels(const KeyEvent& event);
/// Returns whether Dear ImGui would move the focus into a panel if this key is pressed over the picture: only Tab may.
bool moves_focus(const KeyEvent& event);
/// Returns whether the key gives the keyboard back to the picture.
bool leaves_panels(const KeyEvent& event);

/// Returns GLFW_MOD_* of the modifiers that are down.
int mods_held(const Window& window);

}  // namespace shvr::ui
