#pragma once
// Classifies motions of the mouse, and converts them to values. Pure; any thread.

#include <glm/glm.hpp>

#include "engine/look/camera.h"

namespace shvr::ui {

/// Maximum motion between press and release, in pixels, for which they count as a click and not as a drag.
inline constexpr double CLICK_PIXELS = 4.0;
/// Returns whether the motion between two events is too long to be a hand's: longer than a quarter of the pane's height
/// and than 64 pixels. (At 60 events a second, 150 pixels are half a metre a second on most tables.) Causes are a pen
/// that touches down elsewhere, a remote pointer, or a pointer that was over a panel.
bool is_jump(const glm::dvec2& way_pixels, const glm::uvec2& pane_pixels);

/// Returns black and white levels of slices after a drag by `heights`, in pane heights. A sideways drag scales the
/// distance between the levels, by a factor of 4 per half height; a drag down raises both, by their distance per
/// height. `range`: range of the volume's values; the distance is at least a thousandth of it.
ValueRange dragged_contrast(const ValueRange& contrast, const ValueRange& range, const glm::dvec2& heights);

/// Returns the paint threshold for a picked value: the mean of the value and the lowest visible value, since the
/// structure's wall lies between them. If the picked value is not visible, returns the value itself.
double threshold_at(double value, double least_drawn);

}  // namespace shvr::ui
