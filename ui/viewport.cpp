#include "ui/viewport.h"

#include <algorithm>
#include <cmath>

#include <GLFW/glfw3.h>

#include "engine/workbench/edits/edit.h"
#include "engine/workbench/models/preferences.h"
#include "engine/workbench/sight/cut_handles.h"
#include "engine/workbench/sight/gestures.h"
#include "engine/workbench/sight/hits.h"
#include "ui/files/file_list.h"
#include "ui/mouse_feed.h"
#include "ui/panels/tools/outline_tool.h"
#include "ui/panels/tools/point_tool.h"

namespace shvr::ui {

namespace {

constexpr double DEGREES_PER_HEIGHT = 180.0;  ///< a drag over the window's height turns the view by this angle
constexpr double DOUBLE_CLICK_PIXELS = 5.0;
constexpr double ZOOM_PER_STEP = 1.12, RADIUS_PER_STEP = 1.1;
constexpr double ZOOM_PER_HEIGHT = 8.0;  ///< a drag over the window's height zooms by this factor

bool paints(Tool tool)
{
    return tool == Tool::paint || tool == Tool::erase;
}

bool has_slices(const Model& model)
{
    return std::ranges::any_of(model.panes, [](const auto& shown) { return shown.pane.kind == Pane::Kind::slice; });
}

/// Slices' contrast, dragged.
void drag_contrast(const glm::dvec2& heights, const Model& model, Actions& actions)
{
    const auto [lower, upper] = model.statistics.range();
    const SliceSettings& slices = model.session.view.slices;
    const ValueRange was{slices.black.value_or(lower), slices.white.value_or(upper)};
    const ValueRange is = dragged_contrast(was, {lower, upper}, heights);
    set(actions, model, [&](Session& s) {
        s.view.slices.black = is.lower;
        s.view.slices.white = is.upper;
    });
}

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

Pane::Kind Viewport::kind_of_pane(const Model& model) const
{
    return pane_ < model.panes.size() ? model.panes[pane_].pane.kind : Pane::Kind::main;
}

glm::uvec2 Viewport::pane_pixels(const Model& model) const
{
    return pane_ < model.panes.size() ? glm::max(model.panes[pane_].pane.pixels(), glm::uvec2(1)) : glm::uvec2(1);
}

/// Returns a mouse position in pixels of the pane under the mouse.
glm::dvec2 Viewport::in_pane(const glm::dvec2& at, const Model& model) const
{
    const glm::uvec2 origin = pane_ < model.panes.size() ? model.panes[pane_].pane.box.begin : glm::uvec2(0);
    return at - glm::dvec2(layout_.begin + origin);
}

/// Returns the gesture that a turning drag starts in the pane.
Viewport::Gesture Viewport::turning(const Model& model) const
{
    switch (kind_of_pane(model)) {
        case Pane::Kind::map: return Gesture::move_in_map;
        case Pane::Kind::slice: return Gesture::cross;
        default: return Gesture::turn;
    }
}

/// Measures between presses, as widgets do (ui/mouse_feed.h), so that a double click during a long frame is recognised.
bool Viewport::is_double(double earliest_s, const glm::dvec2& at) const
{
    return last_click_s_ && earliest_s - *last_click_s_ < MouseFeed::DOUBLE_CLICK_S &&
           glm::distance(at, last_click_) < DOUBLE_CLICK_PIXELS;
}

// ---- Buttons --------------------------------------------------------------------------------------------------------

void Viewport::press(const ButtonEvent& event, const When& when, const Model& model, Actions& actions)
{
    if (gesture_ != Gesture::none) return;
    pane_ = pane_at(event.at, model);
    const bool is_map = kind_of_pane(model) == Pane::Kind::map, is_slice = kind_of_pane(model) == Pane::Kind::slice;
    const bool turns = model.tool() == Tool::turn, shift = event.mods & GLFW_MOD_SHIFT;
    button_ = event.button;
    const bool was_here = !was_elsewhere_ && event.at == last_;
    last_ = pressed_ = event.at;
    was_elsewhere_ = false;
    const bool paints_right = turns && model.preferences.key_set == KeySet::thesis;
    if (event.button == GLFW_MOUSE_BUTTON_RIGHT && turns && !paints_right) {
        gesture_ = is_map ? Gesture::move_in_map : Gesture::zoom;
    } else if (event.button == GLFW_MOUSE_BUTTON_RIGHT && turns) {
        // The pointer may have moved without an event since the probe last followed it.
        if (!is_map && !was_here) actions.emplace_back(ProbeTo{pane_, in_pane(event.at, model), true});
        gesture_ = Gesture::paint;
        actions.emplace_back(Paint{true});
    } else if (event.button == GLFW_MOUSE_BUTTON_RIGHT) {
        gesture_ = is_slice ? Gesture::contrast : turning(model);
    } else if (event.button == GLFW_MOUSE_BUTTON_MIDDLE) {
        gesture_ = is_map || is_slice ? Gesture::move_in_map : turns || shift ? Gesture::move : turning(model);
    } else if (event.button == GLFW_MOUSE_BUTTON_LEFT) {
        press_left(event, when, model, actions);
    }
    if (gesture_ != Gesture::press && gesture_ != Gesture::paint) click_.reset();
}

/// Takes hold of a handle of the oblique cutting plane or the clip box, if one is shown there.
bool Viewport::takes_handle(const ButtonEvent& event, const Model& model)
{
    const ViewSettings& view = model.session.view;
    if (event.mods != 0 || pane_ >= model.panes.size()) return false;
    cut_before_ = model.session.cut;
    const Pane& pane = model.panes[pane_].pane;
    const glm::dvec2 pixel = in_pane(event.at, model);
    plane_handle_.reset();
    handle_.reset();
    if (view.plane_handles) plane_handle_ = handle_at(plane_handles(pane, cut_before_, model.volume), pixel);
    if (view.cut_box) handle_ = handle_at(cut_handles(pane, cut_before_, model.volume), pixel);
    return plane_handle_ || handle_;
}

/// Moves what is held: the oblique cutting plane, or a face of the clip box.
void Viewport::drag_handle(const glm::dvec2& pixel, const Model& model, Actions& actions) const
{
    if (pane_ >= model.panes.size()) return;
    const Pane& pane = model.panes[pane_].pane;
    const glm::dvec2 from = in_pane(pressed_, model);
    const CutBox cut = plane_handle_ ? dragged(cut_before_, *plane_handle_, pane, model.volume, from, pixel)
                                     : dragged(cut_before_, *handle_, pane, model.volume, from, pixel);
    set(actions, model, [&](Session& s) { s.cut = cut; });
}

void Viewport::press_left(const ButtonEvent& event, const When& when, const Model& model, Actions& actions)
{
    const Pane::Kind kind = kind_of_pane(model);
    pressed_node_.reset();
    pressed_s_ = when.latest_s;
    is_second_ = is_double(when.earliest_s, event.at);
    if (outline_tool().is_on() && kind != Pane::Kind::map && !(event.mods & (GLFW_MOD_SHIFT | GLFW_MOD_ALT)) &&
        pane_ < model.panes.size()) {
        const Pane& pane = model.panes[pane_].pane;
        gesture_ = Gesture::outline;
        outline_tool().begin(pane, glm::dvec2(layout_.begin + pane.box.begin), in_pane(event.at, model),
                             event.mods & GLFW_MOD_CONTROL);
    } else if (point_tool().is_on() && kind != Pane::Kind::map && pane_ < model.panes.size() &&
               !(event.mods & (GLFW_MOD_SHIFT | GLFW_MOD_ALT | GLFW_MOD_CONTROL))) {
        gesture_ = Gesture::point;
        actions.emplace_back(ProbeOnto{pane_, in_pane(event.at, model)});
        point_tool().click();
    } else if (takes_handle(event, model)) {
        gesture_ = Gesture::cut;
    } else if (event.mods & GLFW_MOD_SHIFT) {
        const bool is_flat = kind == Pane::Kind::map || kind == Pane::Kind::slice;
        gesture_ = is_flat ? Gesture::move_in_map : Gesture::move;
    } else if ((event.mods & GLFW_MOD_CONTROL) && kind == Pane::Kind::slice) {
        gesture_ = Gesture::contrast;
    } else if ((event.mods & GLFW_MOD_ALT) || kind == Pane::Kind::map) {
        gesture_ = turning(model);
        if (kind == Pane::Kind::map && is_second_) actions.emplace_back(ProbeOnto{pane_, in_pane(event.at, model)});
        last_click_s_ = pressed_s_;
        last_click_ = event.at;
    } else if (paints(model.tool())) {
        gesture_ = Gesture::stroke;
        actions.emplace_back(ProbeAlong{pane_, in_pane(event.at, model), true});
        actions.emplace_back(Paint{true});
    } else if (kind == Pane::Kind::slice && model.tool() == Tool::turn && model.preferences.key_set != KeySet::thesis) {
        gesture_ = Gesture::cross;
        actions.emplace_back(ProbeTo{pane_, in_pane(event.at, model)});
    } else {
        gesture_ = Gesture::press;
        if (model.tool() == Tool::trace && pane_ < model.panes.size())
            pressed_node_ = trace_hit(model.trace, model.panes[pane_].pane, in_pane(event.at, model), model.volume,
                                      groups_in_pane(model.session, model.panes[pane_].pane))
                                .node;
        // With the turn tool, a double click has its own function, which acts at once and cancels the pending click.
        if (model.tool() == Tool::turn && is_second_) {
            click_.reset();
            actions.emplace_back(ProbeOnto{pane_, in_pane(event.at, model)});
        }
    }
}

void Viewport::release(const ButtonEvent& event, const Model& model, Actions& actions)
{
    if (gesture_ == Gesture::none || event.button != button_) return;
    if (gesture_ == Gesture::paint || gesture_ == Gesture::stroke) actions.emplace_back(Paint{false});
    if (gesture_ == Gesture::node) actions.emplace_back(DragNode{false});
    if (gesture_ == Gesture::outline) outline_tool().end();
    if (gesture_ == Gesture::press) click(model, actions);
    if (gesture_ == Gesture::measure) actions.emplace_back(MeasureAt{pane_, in_pane(last_, model)});
    gesture_ = Gesture::none;
}

void Viewport::click(const Model& model, Actions& actions)
{
    const glm::dvec2 pixel = in_pane(pressed_, model);
    last_click_s_ = is_second_ ? std::nullopt : std::optional(pressed_s_);
    last_click_ = pressed_;
    switch (model.tool()) {
        case Tool::turn:
            if (is_second_) break;
            click_ = Click{{pane_, pixel, false}, pressed_s_};
            if (has_slices(model) && model.preferences.key_set != KeySet::thesis)
                actions.emplace_back(ProbeOnto{pane_, pixel});  // the slices follow
            break;
        case Tool::trace:
            if (pressed_node_)
                actions.emplace_back(SelectOp{.near = {}, .number = pressed_node_, .within_voxels = {}});
            else
                actions.emplace_back(NodeAt{pane_, pixel});
            break;
        case Tool::select: actions.emplace_back(SelectAt{pane_, pixel, is_second_}); break;
        case Tool::measure:
            if (is_second_ && model.session.probe.measure == MeasureKind::path)
                actions.emplace_back(EndMeasure{});
            else
                actions.emplace_back(MeasureAt{pane_, pixel});
            break;
        case Tool::paint:
        case Tool::erase: break;
    }
}

void Viewport::wait(double time_s, Actions& actions)
{
    if (!click_ || time_s - click_->pressed_s < MouseFeed::DOUBLE_CLICK_S) return;
    actions.emplace_back(click_->what);
    click_.reset();
}

// ---- Motion ---------------------------------------------------------------------------------------------------------

/// Begins a drag, once the pointer has moved too far from the press for a click.
void Viewport::begin_drag(const Model& model, Actions& actions)
{
    if (model.tool() == Tool::measure) {  // from the press to the release
        gesture_ = Gesture::measure;
        if (model.measuring.empty()) actions.emplace_back(MeasureAt{pane_, in_pane(pressed_, model)});
        return;
    }
    if (!pressed_node_ || !model.trace.nodes().contains(*pressed_node_)) {
        gesture_ = turning(model);
        return;
    }
    gesture_ = Gesture::node;
    // Dragging a node of a selected segment moves the whole selection.
    const std::vector<uint32_t>& selected = model.trace.selection().nodes;
    if (selected.size() < 2 || std::ranges::find(selected, *pressed_node_) == selected.end())
        actions.emplace_back(SelectOp{.near = {}, .number = pressed_node_, .within_voxels = {}});
    actions.emplace_back(PlaceProbe{model.trace.node(*pressed_node_).position / model.volume.spacing});
    actions.emplace_back(DragNode{true});
}

/// Makes the probe follow the pointer while no button is held. `leads`: the slices follow, too.
void Viewport::hover(const Model& model, bool jumps, bool leads, Actions& actions)
{
    const Tool tool = model.tool();
    const Pane::Kind kind = kind_of_pane(model);
    const glm::dvec2 pixel = in_pane(last_, model);
    const bool points = tool == Tool::select || tool == Tool::measure;
    if (kind == Pane::Kind::slice && points && !leads) return;
    const bool lands = kind != Pane::Kind::map && (leads || (tool != Tool::turn && tool != Tool::select));
    if (lands)
        actions.emplace_back(ProbeAlong{pane_, pixel, jumps, !leads});
    else
        actions.emplace_back(ProbeTo{pane_, pixel, jumps, !leads});
}

void Viewport::follow(const MoveEvent& event, bool ui_has_mouse, const Model& model, Actions& actions)
{
    if (gesture_ == Gesture::none) pane_ = pane_at(event.at, model);
    const glm::dvec2 way = event.at - last_, heights = way / double(pane_pixels(model).y);
    const bool is_here = gesture_ != Gesture::none || (!ui_has_mouse && contains(event.at));
    const bool jumps = was_elsewhere_ || is_jump(way, pane_pixels(model));
    last_ = event.at;
    was_elsewhere_ = !is_here;
    pointer_ = is_here ? std::optional(Pointer{pane_, in_pane(event.at, model)}) : std::nullopt;
    if (gesture_ == Gesture::press && glm::distance(event.at, pressed_) > CLICK_PIXELS) begin_drag(model, actions);
    const glm::dvec2 pixel = in_pane(event.at, model);
    switch (gesture_) {
        // The object follows the mouse, so the eye moves in the opposite direction.
        case Gesture::turn:
            actions.emplace_back(Orbit{-DEGREES_PER_HEIGHT * heights.x, DEGREES_PER_HEIGHT * heights.y});
            break;
        case Gesture::move: actions.emplace_back(Move{{-heights.x, heights.y, 0.0}}); break;
        case Gesture::zoom:
            actions.emplace_back(Zoom{pane_, in_pane(pressed_, model), std::pow(ZOOM_PER_HEIGHT, -heights.y)});
            break;
        case Gesture::move_in_map: actions.emplace_back(DragInMap{pane_, way}); break;
        case Gesture::paint: actions.emplace_back(ProbeTo{pane_, pixel, jumps}); break;
        case Gesture::stroke: actions.emplace_back(ProbeAlong{pane_, pixel, jumps}); break;
        case Gesture::node:
        case Gesture::cross: actions.emplace_back(ProbeTo{pane_, pixel}); break;
        case Gesture::contrast: drag_contrast(heights, model, actions); break;
        case Gesture::outline: outline_tool().drag(pixel); break;
        case Gesture::cut: drag_handle(pixel, model, actions); break;
        case Gesture::measure:
        case Gesture::point:
        case Gesture::press: break;
        case Gesture::none:
            if (is_here) hover(model, jumps, event.mods & GLFW_MOD_SHIFT, actions);
            break;
    }
}

void Viewport::scroll(const ScrollEvent& event, const Model& model, Actions& actions)
{
    constexpr double HEIGHTS_PER_STEP = 0.05;
    pane_ = pane_at(event.at, model);
    const Pane::Kind kind = kind_of_pane(model);
    const bool is_slice = kind == Pane::Kind::slice, has_control = event.mods & GLFW_MOD_CONTROL;
    if (event.mods & GLFW_MOD_SHIFT)
        actions.emplace_back(ScaleProbe{std::pow(RADIUS_PER_STEP, event.steps)});
    else if (is_slice != has_control)  // in slices, or with Ctrl elsewhere, the wheel pushes the probe
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
            release(*button, model, actions);
        else if (!ui_has_mouse && contains(button->at))
            press(*button, {event.earliest_s, event.time_s}, model, actions);
    } else if (const auto* move = std::get_if<MoveEvent>(&event.what)) {
        follow(*move, ui_has_mouse, model, actions);
    } else if (const auto* scroll = std::get_if<ScrollEvent>(&event.what)) {
        if (!ui_has_mouse && contains(scroll->at)) this->scroll(*scroll, model, actions);
    } else if (const auto* drop = std::get_if<DropEvent>(&event.what)) {
        TakeFile taken{.previews = true};
        for (const std::string& dropped : drop->paths) {
            const std::string path = without_query(dropped);  // a link, as from a browser
            if (taken.path.empty())
                taken.path = path;
            else
                taken.beside += path + '\n';
        }
        if (!taken.path.empty()) actions.emplace_back(std::move(taken));
    }
}

}  // namespace shvr::ui
