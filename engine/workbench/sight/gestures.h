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

/// Returns black and white of the slices after a drag by `heights` (of the pane). Dragging sideways scales the distance
/// between them about their middle, by a factor of 4 per half height; dragging down darkens the picture, shifting both
/// by that distance per height. `range`: the volume's value range; the distance is at least a thousandth of it.
ValueRange dragged_contrast(const ValueRange& contrast, const ValueRange& range, const glm::dvec2& heights);

/// Returns the paint threshold for a picked value: half-way to the lowest visible value, since the wall lies between
/// them; for a value that is not visible, the value itself.
double threshold_at(double value, double least_drawn);

}  // namespace shvr::ui
