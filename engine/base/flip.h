#pragma once
// LDR-FLIP: the perceived difference, from 0 (none) to 1 per pixel, of two pictures shown alternately. Andersson et al.
// 2020, "FLIP: A Difference Evaluator for Alternating Images". A metric to report, not to gate on: a difference of one
// 8-bit level everywhere already gives 0.03. Alpha is ignored. Any thread may call these.

#include <numbers>
#include <vector>

#include "engine/base/image.h"
#include "engine/base/progress.h"

namespace shvr {

/// Pixels per degree of a screen 0.7 m wide with 3840 pixels, seen from 0.7 m.
inline constexpr double FLIP_PIXELS_PER_DEGREE = 3840.0 * std::numbers::pi / 180.0;

/// One value per pixel, rows from the top. Both pictures must have the same size.
std::vector<double> flip_map(const Image8& a, const Image8& b, double pixels_per_degree = FLIP_PIXELS_PER_DEGREE,
                             const Progress& progress = {});

}  // namespace shvr
