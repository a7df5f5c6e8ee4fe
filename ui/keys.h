#pragma once
// Turns the keyboard into actions, by the keymap (engine/workbench/bindings/keymap.h). Letters and signs are those of
// the person's layout; keys that steer like a joystick are those at the same place on every keyboard. Main thread.

#include <vector>

#include "engine/workbench/bindings/keymap.h"
#include "ui/window.h"

namespace shvr::ui {

class Keyboard {
public:
    /// A press or a release. `ui_has_keys`: a text is being typed, so presses mean nothing here.
    void handle(const KeyEvent& event, const Model& model, bool ui_has_keys, Actions& actions);
    /// The actions of keys held down, `seconds` after the last call. Keys that `is_down` does not know any more are let
    /// go.
    void hold(double seconds, int mods, const std::function<bool(int key)>& is_down, const Model& model,
              Actions& actions);

private:
    struct Held {
        KeyEvent pressed;
        const Shortcut* lasting = nullptr;  ///< that ends when the key is released
    };
    static void release(const Held& held, const Model& model, Actions& actions);
    std::vector<Held> held_;
};

/// Arrows, Tab, Space, Enter and Escape, without Ctrl and Alt: what Dear ImGui is used with by keyboard.
bool moves_in_panels(const KeyEvent& event);
/// Whether Dear ImGui would take this key, pressed over the picture, for a move into a panel. Tab is the key for that.
bool moves_focus(const KeyEvent& event);
/// Gives the keyboard back to the picture.
bool leaves_panels(const KeyEvent& event);

/// GLFW_MOD_* of the modifiers that are down.
int mods_held(const Window& window);

}  // namespace shvr::ui
