#include "ui/viewport.h"

#include <cmath>

#include <GLFW/glfw3.h>

namespace shvr::ui {

namespace {

constexpr double DEGREES_PER_HEIGHT = 180.0;  ///< a drag across the window turns the view by half a turn
constexpr double DOUBLE_CLICK_S = 0.35;
constexpr double DOUBLE_CLICK_PIXELS = 5.0;
constexpr double ZOOM_PER_STEP = 1.12;

}  // namespace

bool Viewport::contains(const glm::dvec2& at) const
{
    return glm::all(glm::greaterThanEqual(at, glm::dvec2(layout_.begin))) &&
           glm::all(glm::lessThan(at, glm::dvec2(layout_.end)));
}

size_t Viewport::pane_at(const glm::dvec2& at, const Model& model) const
{
    const glm::dvec2 pixel = at - glm::dvec2(layout_.begin);
    for (size_t i = 0; i < model.panes.size(); ++i) {
        const PixelBox& box = model.panes[i].pane.box;
        if (glm::all(glm::greaterThanEqual(pixel, glm::dvec2(box.begin))) &&
            glm::all(glm::lessThan(pixel, glm::dvec2(box.end))))
            return i;
    }
    return 0;
}

/// In pixels of the pane under the mouse.
glm::dvec2 Viewport::in_pane(const glm::dvec2& at, const Model& model) const
{
    const glm::uvec2 origin = pane_ < model.panes.size() ? model.panes[pane_].pane.box.begin : glm::uvec2(0);
    return at - glm::dvec2(layout_.begin + origin);
}

void Viewport::press(const ButtonEvent& event, double time_s, const Model& model, Actions& actions)
{
    if (gesture_ != Gesture::none) return;
    pane_ = pane_at(event.at, model);
    const bool is_map = pane_ < model.panes.size() && model.panes[pane_].pane.kind == Pane::Kind::map;
    button_ = event.button;
    last_ = event.at;
    if (event.button == GLFW_MOUSE_BUTTON_RIGHT) {
        gesture_ = Gesture::paint;
        actions.emplace_back(Paint{true});
    } else if (event.button == GLFW_MOUSE_BUTTON_MIDDLE || (event.mods & GLFW_MOD_SHIFT)) {
        gesture_ = is_map ? Gesture::move_in_map : Gesture::move;
    } else if (event.button == GLFW_MOUSE_BUTTON_LEFT) {
        gesture_ = is_map ? Gesture::move_in_map : Gesture::turn;
        const bool is_double = last_click_s_ && time_s - *last_click_s_ < DOUBLE_CLICK_S &&
                               glm::distance(event.at, last_click_) < DOUBLE_CLICK_PIXELS;
        if (is_double) actions.emplace_back(ProbeOnto{pane_, in_pane(event.at, model)});
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

void Viewport::follow(const MoveEvent& event, bool ui_has_mouse, const Model& model, Actions& actions)
{
    if (gesture_ == Gesture::none) pane_ = pane_at(event.at, model);
    const double height = pane_ < model.panes.size()
                              ? double(model.panes[pane_].pane.box.end.y - model.panes[pane_].pane.box.begin.y)
                              : 1.0;
    const glm::dvec2 way = event.at - last_, heights = way / std::max(1.0, height);
    last_ = event.at;
    switch (gesture_) {
        // The object follows the mouse, so the eye moves the other way.
        case Gesture::turn:
            actions.emplace_back(Orbit{-DEGREES_PER_HEIGHT * heights.x, DEGREES_PER_HEIGHT * heights.y});
            break;
        case Gesture::move: actions.emplace_back(Move{{-heights.x, heights.y, 0.0}}); break;
        case Gesture::move_in_map: actions.emplace_back(DragInMap{pane_, way}); break;
        case Gesture::paint: actions.emplace_back(ProbeTo{pane_, in_pane(event.at, model)}); break;
        case Gesture::none:
            if (!ui_has_mouse && contains(event.at)) actions.emplace_back(ProbeTo{pane_, in_pane(event.at, model)});
            break;
    }
}

void Viewport::scroll(const ScrollEvent& event, const Model& model, Actions& actions)
{
    constexpr double HEIGHTS_PER_STEP = 0.05;
    pane_ = pane_at(event.at, model);
    const Pane::Kind kind = pane_ < model.panes.size() ? model.panes[pane_].pane.kind : Pane::Kind::main;
    if (kind == Pane::Kind::slice || (event.mods & GLFW_MOD_CONTROL))
        actions.emplace_back(PushProbe{pane_, event.steps});
    else if (kind == Pane::Kind::map)
        actions.emplace_back(Move{{0.0, 0.0, HEIGHTS_PER_STEP * event.steps}});
    else
        actions.emplace_back(Zoom{pane_, in_pane(event.at, model), std::pow(ZOOM_PER_STEP, event.steps)});
}

void Viewport::handle(const InputEvent& event, const Model& model, bool ui_has_mouse, Actions& actions)
{
    if (const auto* button = std::get_if<ButtonEvent>(&event.what)) {
        if (!button->pressed)
            release(*button, actions);
        else if (!ui_has_mouse && contains(button->at))
            press(*button, event.time_s, model, actions);
    } else if (const auto* move = std::get_if<MoveEvent>(&event.what)) {
        follow(*move, ui_has_mouse, model, actions);
    } else if (const auto* scroll = std::get_if<ScrollEvent>(&event.what)) {
        if (!ui_has_mouse && contains(scroll->at)) this->scroll(*scroll, model, actions);
    } else if (const auto* drop = std::get_if<DropEvent>(&event.what)) {
        for (const std::string& path : drop->paths) actions.emplace_back(TakeFile{path});
    }
}

}  // namespace shvr::ui
