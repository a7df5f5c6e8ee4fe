#include "ui/viewport.h"

#include <cmath>

#include <GLFW/glfw3.h>

namespace shvr::ui {

namespace {

constexpr double DEGREES_PER_HEIGHT = 180.0;  ///< a drag across the window turns by half a turn
constexpr double DOUBLE_CLICK_S = 0.35;
constexpr double DOUBLE_CLICK_PIXELS = 5.0;
constexpr double ZOOM_PER_STEP = 1.12;
constexpr int PAINT_KEY = GLFW_KEY_F;

}  // namespace

bool Viewport::contains(const glm::dvec2& at) const
{
    return glm::all(glm::greaterThanEqual(at, glm::dvec2(layout_.begin))) &&
           glm::all(glm::lessThan(at, glm::dvec2(layout_.end)));
}

void Viewport::press(const ButtonEvent& event, double time_s, Actions& actions)
{
    if (gesture_ != Gesture::none) return;
    button_ = event.button;
    last_ = event.at;
    if (event.button == GLFW_MOUSE_BUTTON_RIGHT) {
        gesture_ = Gesture::paint;
        actions.emplace_back(Paint{true});
    } else if (event.button == GLFW_MOUSE_BUTTON_MIDDLE || (event.mods & GLFW_MOD_SHIFT)) {
        gesture_ = Gesture::move;
    } else if (event.button == GLFW_MOUSE_BUTTON_LEFT) {
        gesture_ = Gesture::turn;
        const bool is_double = last_click_s_ && time_s - *last_click_s_ < DOUBLE_CLICK_S &&
                               glm::distance(event.at, last_click_) < DOUBLE_CLICK_PIXELS;
        if (is_double) actions.emplace_back(ProbeOnto{local(event.at)});
        last_click_s_ = is_double ? std::nullopt : std::optional(time_s);
        last_click_ = event.at;
    }
}

void Viewport::release(const ButtonEvent& event, Actions& actions)
{
    if (gesture_ == Gesture::none || event.button != button_) return;
    if (gesture_ == Gesture::paint) actions.emplace_back(Paint{false});
    gesture_ = Gesture::none;
}

void Viewport::follow(const MoveEvent& event, bool ui_has_mouse, Actions& actions)
{
    const glm::dvec2 heights = (event.at - last_) / std::max(1.0, double(pixels().y));
    last_ = event.at;
    switch (gesture_) {
        // What is under the mouse goes along with it, so the eye goes the other way.
        case Gesture::turn:
            actions.emplace_back(Orbit{-DEGREES_PER_HEIGHT * heights.x, DEGREES_PER_HEIGHT * heights.y});
            break;
        case Gesture::move: actions.emplace_back(Move{{-heights.x, heights.y, 0.0}}); break;
        case Gesture::paint: actions.emplace_back(ProbeTo{local(event.at)}); break;
        case Gesture::none:
            if (!ui_has_mouse && contains(event.at)) actions.emplace_back(ProbeTo{local(event.at)});
            break;
    }
}

void Viewport::handle(const InputEvent& event, const Model& model, bool ui_has_mouse, bool ui_has_keys,
                      Actions& actions)
{
    if (const auto* button = std::get_if<ButtonEvent>(&event.what)) {
        if (!button->pressed)
            release(*button, actions);
        else if (!ui_has_mouse && contains(button->at))
            press(*button, event.time_s, actions);
    } else if (const auto* move = std::get_if<MoveEvent>(&event.what)) {
        follow(*move, ui_has_mouse, actions);
    } else if (const auto* scroll = std::get_if<ScrollEvent>(&event.what)) {
        if (ui_has_mouse || !contains(scroll->at)) return;
        if (scroll->mods & GLFW_MOD_CONTROL)
            actions.emplace_back(PushProbe{scroll->steps});
        else
            actions.emplace_back(Zoom{local(scroll->at), std::pow(ZOOM_PER_STEP, scroll->steps)});
    } else if (const auto* key = std::get_if<KeyEvent>(&event.what)) {
        if (key->key == PAINT_KEY && key->mods == 0 && !key->repeated && (!ui_has_keys || !key->pressed))
            actions.emplace_back(Paint{key->pressed});
        else if (key->pressed && !ui_has_keys)
            key_pressed(*key, model, actions);
    } else if (const auto* drop = std::get_if<DropEvent>(&event.what)) {
        if (!drop->paths.empty()) actions.emplace_back(Open{drop->paths.front()});
    }
}

}  // namespace shvr::ui
