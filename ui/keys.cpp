#include "ui/keys.h"

#include <algorithm>
#include <cctype>
#include <functional>

#include <GLFW/glfw3.h>

namespace shvr::ui {

namespace {

constexpr double SLOWED = 0.2;
constexpr double TAPS_PER_SECOND = 5.0;  ///< a held key acts as often as this many taps per second
constexpr double MAX_FRAME_S = 0.5;      ///< limits the motion by a held key after a hung frame

/// Keys that stand for no character.
std::string name_of_key(int key)
{
    switch (key) {
        case GLFW_KEY_SPACE: return "Space";
        case GLFW_KEY_DELETE: return "Delete";
        case GLFW_KEY_INSERT: return "Insert";
        case GLFW_KEY_HOME: return "Home";
        case GLFW_KEY_END: return "End";
        case GLFW_KEY_PAGE_UP: return "PageUp";
        case GLFW_KEY_PAGE_DOWN: return "PageDown";
        case GLFW_KEY_UP: return "Up";
        case GLFW_KEY_DOWN: return "Down";
        case GLFW_KEY_LEFT: return "Left";
        case GLFW_KEY_RIGHT: return "Right";
        case GLFW_KEY_TAB: return "Tab";
        case GLFW_KEY_ENTER: return "Enter";
        case GLFW_KEY_BACKSPACE: return "Backspace";
        case GLFW_KEY_ESCAPE: return "Escape";
        case GLFW_KEY_PAUSE: return "Pause";
        default: break;
    }
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F25) return "F" + std::to_string(key - GLFW_KEY_F1 + 1);
    return {};
}

/// Returns the name that a key's position has on an American keyboard: GLFW's codes of printable keys are ASCII.
std::string name_at_place(int key)
{
    const std::string name = name_of_key(key);
    return !name.empty() ? name : key > GLFW_KEY_SPACE && key < 127 ? std::string(1, char(key)) : std::string();
}

/// Returns the key's name in the user's layout. Digits use the position, since some layouts need Shift for digits.
std::string name_in_layout(const KeyEvent& event)
{
    const bool is_digit = event.key >= GLFW_KEY_0 && event.key <= GLFW_KEY_9;
    if (event.character.empty() || is_digit || !name_of_key(event.key).empty()) return name_at_place(event.key);
    std::string name = event.character;
    if (name.size() == 1 && name[0] >= 'a' && name[0] <= 'z') name[0] = char(name[0] - 'a' + 'A');
    return name;
}

Chord chord_with(std::string key, int mods)
{
    return {.control = (mods & GLFW_MOD_CONTROL) != 0,
            .alt = (mods & GLFW_MOD_ALT) != 0,
            .shift = (mods & GLFW_MOD_SHIFT) != 0,
            .key = std::move(key)};
}

/// Returns the shortcut of a pressed key: only one, also where one is bound to its name and one to its position.
const Shortcut* shortcut_for(const KeyEvent& event, int mods, const Keymap& keymap)
{
    const auto found = [&](const std::string& key, bool is_by_position) {
        const Shortcut* const shortcut = keymap.shortcut_for(chord_with(key, mods));
        return shortcut && shortcut->is_by_position == is_by_position ? shortcut : nullptr;
    };
    const std::string in_layout = name_in_layout(event), at_place = name_at_place(event.key);
    if (const Shortcut* const named = found(in_layout, false)) return named;
    if (const Shortcut* const placed = found(at_place, true)) return placed;
    // Falls back to the key at this position on an American keyboard, such as brackets instead of German umlauts.
    const bool is_letter = in_layout.size() == 1 && std::isalnum(static_cast<unsigned char>(in_layout[0]));
    return !is_letter && in_layout != at_place ? found(at_place, false) : nullptr;
}

double rate(const Shortcut& shortcut, int mods)
{
    return shortcut.is_slowed() && (mods & GLFW_MOD_SHIFT) ? SLOWED : 1.0;
}

/// Binds the pressed key to the shortcut that awaits a key. Modifiers alone are ignored.
void bind(const KeyEvent& event, const Model& model, Actions& actions)
{
    const Shortcut* const shortcut = shortcut_named(model.awaits_key);
    const std::string key = shortcut && shortcut->is_by_position ? name_at_place(event.key) : name_in_layout(event);
    const std::string text = text_of(chord_with(key, event.mods));
    if (event.key == GLFW_KEY_ESCAPE)
        actions.push_back(AwaitKey{});
    else if (event.key == GLFW_KEY_DELETE && event.mods == 0)
        actions.push_back(BindKeys{std::string(model.awaits_key), ""});
    else if (!event.repeated && !key.empty())  // keys that cannot be bound are refused with a message
        actions.push_back(BindKeys{std::string(model.awaits_key), text});
}

}  // namespace

void Keyboard::release(const Held& held, const Model& model, Actions& actions)
{
    if (held.lasting) actions.push_back(held.lasting->action(model, 0.0));
}

void Keyboard::handle(const KeyEvent& event, const Model& model, bool ui_has_keys, Actions& actions)
{
    const auto known = std::ranges::find_if(held_, [&](const Held& held) { return held.pressed.key == event.key; });
    if (!event.pressed) {
        if (known == held_.end()) return;
        release(*known, model, actions);
        held_.erase(known);
        return;
    }
    if (ui_has_keys) return;
    if (!model.awaits_key.empty()) return bind(event, model, actions);
    // An action that the user bound takes the place of shortcuts: by the key's name in the layout, as it was bound.
    if (const Action* const bound = model.keymap.action_for(chord_with(name_in_layout(event), event.mods))) {
        if (!event.repeated) actions.push_back(*bound);
        return;
    }
    Held held{.pressed = event};
    const Shortcut* const shortcut = shortcut_for(event, event.mods, model.keymap);
    if (shortcut && (!event.repeated || shortcut->mode == Shortcut::Mode::repeated)) {
        actions.push_back(shortcut->action(model, rate(*shortcut, event.mods)));
        if (shortcut->mode == Shortcut::Mode::while_held) held.lasting = shortcut;
    }
    if (!event.repeated && known == held_.end()) held_.push_back(held);
}

void Keyboard::hold(double seconds, int mods, const std::function<bool(int key)>& is_down, const Model& model,
                    Actions& actions)
{
    const double taps = TAPS_PER_SECOND * std::clamp(seconds, 0.0, MAX_FRAME_S);
    std::erase_if(held_, [&](const Held& held) {
        if (is_down(held.pressed.key)) return false;
        release(held, model, actions);
        return true;
    });
    for (const Held& held : held_) {
        // When the user releases Ctrl + S, Ctrl may come first: the S that is still held must not act as a shortcut.
        const Shortcut* const shortcut = shortcut_for(held.pressed, mods, model.keymap);
        if (shortcut && shortcut->mode == Shortcut::Mode::hold &&
            shortcut == shortcut_for(held.pressed, held.pressed.mods, model.keymap))
            actions.push_back(shortcut->action(model, taps * rate(*shortcut, mods)));
    }
}

bool moves_in_panels(const KeyEvent& event)
{
    constexpr int KEYS[] = {GLFW_KEY_UP,    GLFW_KEY_DOWN,  GLFW_KEY_LEFT,     GLFW_KEY_RIGHT, GLFW_KEY_TAB,
                            GLFW_KEY_SPACE, GLFW_KEY_ENTER, GLFW_KEY_KP_ENTER, GLFW_KEY_ESCAPE};
    return std::ranges::find(KEYS, event.key) != std::end(KEYS) && !(event.mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT));
}

bool moves_focus(const KeyEvent& event)
{
    constexpr int KEYS[] = {GLFW_KEY_UP,    GLFW_KEY_DOWN,  GLFW_KEY_LEFT,    GLFW_KEY_RIGHT,
                            GLFW_KEY_HOME,  GLFW_KEY_END,   GLFW_KEY_PAGE_UP, GLFW_KEY_PAGE_DOWN,
                            GLFW_KEY_SPACE, GLFW_KEY_ENTER, GLFW_KEY_KP_ENTER};
    return std::ranges::find(KEYS, event.key) != std::end(KEYS);
}

bool types_text(const KeyEvent& event)
{
    return event.key < GLFW_KEY_ESCAPE && !(event.mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT));
}

bool is_modifier(const KeyEvent& event)
{
    return event.key >= GLFW_KEY_LEFT_SHIFT && event.key <= GLFW_KEY_RIGHT_SUPER;
}

bool leaves_panels(const KeyEvent& event)
{
    return event.pressed && !event.repeated && event.key == GLFW_KEY_ESCAPE;
}

int mods_held(const Window& window)
{
    const auto either = [&](int left, int right, int mod) {
        return window.is_down(left) || window.is_down(right) ? mod : 0;
    };
    return either(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL, GLFW_MOD_CONTROL) |
           either(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT, GLFW_MOD_ALT) |
           either(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT, GLFW_MOD_SHIFT);
}

}  // namespace shvr::ui
