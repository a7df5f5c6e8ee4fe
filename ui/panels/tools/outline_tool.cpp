#include "ui/panels/tools/outline_tool.h"

#include "engine/workbench/sight/gestures.h"
#include "engine/workbench/sight/outlines.h"

namespace shvr::ui {

OutlineTool& outline_tool()
{
    static OutlineTool tool;
    return tool;
}

void OutlineTool::set_on(bool is_on)
{
    if (is_on_ == is_on) return;
    is_on_ = is_on;
    clear();
}

void OutlineTool::begin(const Pane& pane, const glm::dvec2& origin, const glm::dvec2& pixel, bool other_shape)
{
    clear();
    is_rectangle_ = (shape == Shape::rectangle) != other_shape;
    is_drawing_ = true;
    drawn_ = Drawn{pane, origin, {pixel}};
}

/// A lasso takes a point for every two pixels at least; LassoOp::MAX_POINTS is far more than a hand draws.
void OutlineTool::drag(const glm::dvec2& pixel)
{
    constexpr double STEP_PIXELS = 2.0;
    if (!is_drawing_) return;
    std::vector<glm::dvec2>& outline = drawn_->outline;
    if (is_rectangle_)
        outline = rectangle_of(outline.front(), pixel);
    else if (glm::distance(outline.back(), pixel) >= STEP_PIXELS && outline.size() < LassoOp::MAX_POINTS)
        outline.push_back(pixel);
}

bool OutlineTool::end()
{
    if (!is_drawing_) return false;
    is_drawing_ = false;
    glm::dvec2 lower = drawn_->outline.front(), upper = lower;
    for (const glm::dvec2& point : drawn_->outline) {
        lower = glm::min(lower, point);
        upper = glm::max(upper, point);
    }
    const bool is_kept = drawn_->outline.size() >= 3 && glm::length(upper - lower) > CLICK_PIXELS;
    if (!is_kept) clear();
    return is_kept;
}

void OutlineTool::clear()
{
    drawn_.reset();
    is_drawing_ = false;
    wish_ = Wish::none;
}

void OutlineTool::set(LassoOp& op, std::optional<double> depth, const Model& model) const
{
    if (drawn_ && !is_drawing_)
        set_outline(op, drawn_->pane, drawn_->outline, depth, model.session.cut, model.volume);
    else
        op.polygon.clear();
}

bool OutlineTool::wants(Wish wish)
{
    if (!is_on_ || !drawn_ || (is_drawing_ && wish == Wish::apply)) return false;
    wish_ = wish;
    return true;
}

}  // namespace shvr::ui
