#pragma once
// Converts the mouse in the graphics window to actions. Its state is the layout of that window and the gesture in
// progress. Main thread.
//
// The session's tool (engine/session/session.h) determines the effect of the left button:
//
//   turn      a drag turns, a click selects what is under the pointer, a double click puts the probe there; next
//             to slices, which follow the probe, a click does that, too (not with the keys of the thesis)
//   paint     paints, while the button is held, at the visible point under the pointer; erase likewise
//   trace     a click on a node selects it, a drag moves it; a click elsewhere adds a node; any other drag turns
//   select    a click selects, a double click the whole segment; a drag turns
//   measure   clicks set points, and so do the ends of a drag; a double click ends a path
//
//   no button          the probe follows in its plane; with paint, erase, trace and measure, it follows visible points.
//                      Slices stay where they are; with Shift they go through the visible point under the pointer
//   right              turn tool: zoom; otherwise turn            Shift + left     move
//   middle             turn tool: move; otherwise turn, with Shift move           Alt + left       turn
//   wheel              zoom; with Ctrl push the probe away, or pull it closer; with Shift the size of the probe
//
// In a map, the gestures for turning and moving both move the camera, and the wheel moves it forward. In a slice, the
// wheel moves the slice; the gestures for turning drag the cross, which moves the other slices, and the press of the
// turn tool puts it there (not with the keys of the thesis); Ctrl + left changes the contrast, and so does the right
// button with all tools but turn. With the keys of the thesis, the right button paints in the turn tool.
//
// The left button without modifiers drags the handles of the clip box (cut_handles.h), while that is shown
// (`view.cut_box`), and those of the oblique cutting plane (plane_handles.h).
//
// While the window of operations shows a cut, a drag with the left button draws its outline (outline_tool.h); Ctrl
// changes between lasso and rectangle.
//
// A motion that no hand makes (is_jump) lifts the brush, and so does the first motion after the pointer was elsewhere.

#include <optional>

#include "engine/workbench/sight/cut_handles.h"
#include "engine/workbench/sight/plane_handles.h"
#include "ui/panels/panels.h"
#include "ui/window.h"

namespace shvr::ui {

class Viewport {
public:
    void set_layout(const Layout& layout) { layout_ = layout; }
    const Layout& layout() const { return layout_; }
    glm::uvec2 pixels() const { return layout_.end - layout_.begin; }

    /// Handles all events except keys. `ui_has_mouse`: Dear ImGui uses the mouse.
    void handle(const InputEvent& event, const Model& model, bool ui_has_mouse, Actions& actions);
    /// Handles timeouts: a click with the turn tool selects once it can no longer become a double click.
    void wait(double time_s, Actions& actions);
    /// Returns whether a timeout is pending.
    bool is_waiting() const { return click_.has_value(); }
    /// Returns the position of the mouse over the picture; null if the mouse is elsewhere.
    const std::optional<Pointer>& pointer() const { return pointer_; }
    bool contains(const glm::dvec2& at) const;

private:
    enum class Gesture {
        none,
        press,  ///< may still become a click or a drag
        turn,
        move,
        move_in_map,
        zoom,
        paint,    ///< at the probe, in its plane
        stroke,   ///< along the visible surface
        node,     ///< moves the pressed node
        cross,    ///< moves the cross of the slices
        outline,  ///< draws the outline of a cut
        point,    ///< answers a dialog that asks for a point
        cut,      ///< moves a face of the clip box, or the oblique cutting plane
        measure,  ///< the other end of a distance
        contrast
    };
    struct When {
        double earliest_s = 0.0, latest_s = 0.0;  ///< the event happened between these two times
    };
    void press(const ButtonEvent& event, const When& when, const Model& model, Actions& actions);
    void press_left(const ButtonEvent& event, const When& when, const Model& model, Actions& actions);
    bool takes_handle(const ButtonEvent& event, const Model& model);
    void drag_handle(const glm::dvec2& pixel, const Model& model, Actions& actions) const;
    void release(const ButtonEvent& event, const Model& model, Actions& actions);
    void click(const Model& model, Actions& actions);
    void begin_drag(const Model& model, Actions& actions);
    void follow(const MoveEvent& event, bool ui_has_mouse, const Model& model, Actions& actions);
    void hover(const Model& model, bool jumps, bool leads, Actions& actions);
    void scroll(const ScrollEvent& event, const Model& model, Actions& actions);
    size_t pane_at(const glm::dvec2& at, const Model& model) const;
    Pane::Kind kind_of_pane(const Model& model) const;
    glm::uvec2 pane_pixels(const Model& model) const;
    Gesture turning(const Model& model) const;
    glm::dvec2 in_pane(const glm::dvec2& at, const Model& model) const;
    bool is_double(double earliest_s, const glm::dvec2& at) const;

    Layout layout_;
    Gesture gesture_ = Gesture::none;
    size_t pane_ = 0;  ///< pane under the mouse or, during a gesture, the pane where it began
    int button_ = 0;
    glm::dvec2 last_{0.0}, pressed_{0.0};
    std::optional<uint32_t> pressed_node_;
    std::optional<CutHandle> handle_;          ///< handle of the clip box that is held
    std::optional<PlaneHandle> plane_handle_;  ///< handle of the oblique cutting plane that is held
    CutBox cut_before_;                        ///< the cut before the drag
    bool was_elsewhere_ = true;                ///< at the last motion, the pointer was outside the picture
    std::optional<Pointer> pointer_;
    double pressed_s_ = 0.0;              ///< latest time of the left button's press
    bool is_second_ = false;              ///< the press is the second of a double click
    std::optional<double> last_click_s_;  ///< press time of the last click
    glm::dvec2 last_click_{0.0};
    struct Click {
        SelectAt what;
        double pressed_s = 0.0;
    };
    std::optional<Click> click_;  ///< click with the turn tool that may still become a double click
};

}  // namespace shvr::ui
