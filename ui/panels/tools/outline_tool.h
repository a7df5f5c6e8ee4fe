#pragma once
// The mouse as a pair of scissors: while the window of operations shows a cut, a drag with the left button in the
// picture draws its outline. The viewport feeds it, the window of operations takes what is drawn. Main thread.

#include <optional>
#include <utility>
#include <vector>

#include "engine/workbench/actions/group_actions.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

class OutlineTool {
public:
    enum class Shape { lasso, rectangle };
    /// An outline over a pane, in its pixels.
    struct Drawn {
        Pane pane;
        glm::dvec2 origin{0.0};  ///< corner of the pane, in pixels of the window
        std::vector<glm::dvec2> outline{};
    };
    enum class Wish { none, apply, cancel };

    /// Off: drags mean what the session's tool says.
    void set_on(bool is_on);
    bool is_on() const { return is_on_; }
    Shape shape = Shape::lasso;  ///< what a drag draws; with Ctrl, it draws the other

    void begin(const Pane& pane, const glm::dvec2& origin, const glm::dvec2& pixel, bool other_shape);
    void drag(const glm::dvec2& pixel);
    /// Keeps the outline unless it is too small to have been meant. Returns whether it is kept.
    bool end();
    void clear();

    /// Gives the operation the outline that was drawn, or none (set_outline of engine/workbench/sight/outlines.h).
    void set(LassoOp& op, std::optional<double> depth, const Model& model) const;

    /// What is drawn, or was drawn last, until it is cleared.
    const std::optional<Drawn>& drawn() const { return drawn_; }
    bool is_drawing() const { return is_drawing_; }
    /// Enter and Escape over the picture, for the window of operations. Returns whether the key was meant for the cut.
    bool wants(Wish wish);
    Wish take_wish() { return std::exchange(wish_, Wish::none); }

private:
    bool is_on_ = false, is_drawing_ = false, is_rectangle_ = false;
    Wish wish_ = Wish::none;
    std::optional<Drawn> drawn_{};
};

/// The only one: there is one mouse.
OutlineTool& outline_tool();

}  // namespace shvr::ui
