#pragma once
// What motions of the mouse mean, as numbers. Pure; any thread.

#include <glm/glm.hpp>

#include "engine/look/camera.h"

namespace shvr::ui {

/// A press that moved no farther than this is a click; more is a drag. Pixels.
inline constexpr double CLICK_PIXELS = 4.0;
/// A hand moves less far from one event to the next than a quarter of the pane's height, or 64 pixels in a low one: at
/// 60 events a second 150 pixels are half a metre a second on most tables. What moves farther was put there: a pen that
/// comes down elsewhere, a remote pointer, a pointer that was over a panel.
bool is_jump(const glm::dvec2& way_pixels, const glm::uvec2& pane_pixels);

/// Black and white of slices after a drag of so many heights of the pane: sideways changes their distance, by a factor
/// of 4 for half a height, about the middle; down makes the picture darker, by their distance for a whole height.
/// `range`: of the volume, whose thousandth is the least distance.
ValueRange dragged_contrast(const ValueRange& contrast, const ValueRange& range, const glm::dvec2& heights);

/// The paint threshold for what has this value: half-way to the least that is drawn, where the wall between them lies;
/// of what is not drawn, its own value.
double threshold_at(double value, double least_drawn);

}  // namespace shvr::ui
