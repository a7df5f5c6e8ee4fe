#pragma once
// The curve that maps the light that arrives to the light that is seen, as a hand edits it: points on a square, x and y
// from 0 to 1. Pure; any thread.

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/look/settings.h"

namespace shvr::ui {

using OcclusionPoints = std::vector<OcclusionPoint>;

/// The power as points, to go on from.
OcclusionPoints points_of_power(double power);
/// The nearest within `reach`, along each axis.
std::optional<size_t> point_under(const OcclusionPoints& points, const glm::dvec2& place, const glm::dvec2& reach);
/// Within the square, and between its neighbours, so that its index stays the same.
OcclusionPoints moved(OcclusionPoints points, size_t point, const OcclusionPoint& to);
/// Where it was put; without a change where there are MAX_OCCLUSION_POINTS.
size_t add(OcclusionPoints& points, const OcclusionPoint& point);
/// Two stay.
OcclusionPoints without(OcclusionPoints points, size_t point);
/// In the middle of the widest gap, on the curve.
OcclusionPoint in_widest_gap(const OcclusionPoints& points);

}  // namespace shvr::ui
