#pragma once
// Classifies motions of the mouse, and converts them to values. Pure; any thread.

#include <glm/glm.hpp>

#include "engine/look/camera.h"

namespace shvr::ui {

/// A press that moves at most this far is a click; farther is a drag. Pixels.
inline constexpr double CLICK_PIXELS = 4.0;
/// Returns whether a motion between two events is too far for a hand: more than a quarter of the pane's height, or
/// than 64 pixels in a low one (at 60 events a second 150 pixels are half a metre a second on most tables). Causes: a
/// pen that comes down elsewhere, a remote pointer, a pointer that was over a panel.
bool is_jump(const glm::dvec2& way_pixels, const glm::uvec2& pane_pixels);

/// Returns black and white of slices after a drag, in heights of the pane: sideways scales their distance about the
/// middle, by a factor of 4 for half a height; down makes the picture darker, by their distance for a whole height.
/// `range`: the volume's; a thousandth of it is the minimum distance.
ValueRange dragged_contrast(const ValueRange& contrast, const ValueRange& range, const glm::dvec2& heights);

/// Returns the paint threshold for a picked value: half-way to the lowest visible value, since the wall lies between
/// them; for a value that is not visible, the value itself.
double threshold_at(double value, double least_drawn);

}  // namespace shvr::ui
