#pragma once
// Classifies motions of the mouse, and converts them to values. Pure; any thread.

#include <glm/glm.hpp>

#include "engine/look/camera.h"

namespace shvr::ui {

/// Maximum motion of a press that counts as a click, in pixels; a longer motion is a drag.
inline constexpr double CLICK_PIXELS = 4.0;
/// Returns whether a motion between two events is too long for a hand: longer than a quarter of the pane's height or,
/// in a low pane, than 64 pixels (at 60 events a second, 150 pixels are half a metre a second on most tables). Causes
/// are a pen that comes down elsewhere, a remote pointer, or a pointer that was over a panel.
bool is_jump(const glm::dvec2& way_pixels, const glm::uvec2& pane_pixels);

/// Returns the black and white levels of the slices after a drag by `heights` of the pane. A sideways drag scales the
/// distance of the levels about their middle, by a factor of 4 per half height. A drag down darkens: it shifts both
/// levels by their distance per height. `range`: the volume's; the distance is at least a thousandth of it.
ValueRange dragged_contrast(const ValueRange& contrast, const ValueRange& range, const glm::dvec2& heights);

/// Returns the paint threshold for a picked value: half-way between that and the lowest visible value, since the
/// structure's wall lies between the two; if the picked value is not visible, the value itself.
double threshold_at(double value, double least_drawn);

}  // namespace shvr::ui
