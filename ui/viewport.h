#pragma once
// Turns the mouse in the graphics window into actions. Its only state is the layout of that window and the gesture
// in progress. Main thread.
//
//   no button          the probe follows in its plane          wheel          zoom
//   left drag          turn                                    Ctrl + wheel   push the probe away, or pull it closer
//   middle drag        move (also Shift + left drag)           double click   put the probe onto the surface there
//   right held         paint, or add a node
//
// In a map, left and middle drag move the camera and the wheel takes it forward; in a slice the wheel moves the slice.

#include <optional>

#include "ui/panels/panels.h"
#include "ui/window.h"

namespace shvr::ui {

class Viewport {
public:
    void set_layout(const Layout& layout) { layout_ = layout; }
    const Layout& layout() const { return layout_; }
    glm::uvec2 pixels() const { return layout_.end - layout_.begin; }

    /// All events but keys. `ui_has_mouse`: Dear ImGui uses it.
    void handle(const InputEvent& event, const Model& model, bool ui_has_mouse, Actions& actions);

private:
    enum class Gesture { none, turn, move, move_in_map, paint };
    void press(const ButtonEvent& event, double time_s, const Model& model, Actions& actions);
    void release(const ButtonEvent& event, Actions& actions);
    void follow(const MoveEvent& event, bool ui_has_mouse, const Model& model, Actions& actions);
    void scroll(const ScrollEvent& event, const Model& model, Actions& actions);
    size_t pane_at(const glm::dvec2& at, const Model& model) const;
    glm::dvec2 in_pane(const glm::dvec2& at, const Model& model) const;
    bool contains(const glm::dvec2& at) const;

    Layout layout_;
    Gesture gesture_ = Gesture::none;
    size_t pane_ = 0;  ///< under the mouse, or where the gesture began
    int button_ = 0;
    glm::dvec2 last_{0.0};
    std::optional<double> last_click_s_;
    glm::dvec2 last_click_{0.0};
};

}  // namespace shvr::ui
