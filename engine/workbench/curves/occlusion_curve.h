#pragma once
// A curve edited by hand, from arriving ambient light to displayed light: points in a square with x and y from 0 to 1.
// Pure; any thread.

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/look/settings.h"

namespace shvr::ui {

using OcclusionPoints = std::vector<OcclusionPoint>;

/// Returns points that approximate the power function with this exponent, as a start for editing.
OcclusionPoints points_of_power(double power);
/// Returns the point nearest to `place` whose distance along each axis is at most `reach`; null if there is none.
std::optional<size_t> point_under(const OcclusionPoints& points, const glm::dvec2& place, const glm::dvec2& reach);
/// Moves a point, but only within the square and between its neighbours, so that its index stays the same.
OcclusionPoints moved(OcclusionPoints points, size_t point, const OcclusionPoint& to);
/// Inserts a point and returns its index. Changes nothing if there are already MAX_OCCLUSION_POINTS points.
size_t add(OcclusionPoints& points, const OcclusionPoint& point);
/// Removes a point; keeps at least two.
OcclusionPoints without(OcclusionPoints points, size_t point);
/// Returns the point on the curve in the middle of the widest gap between points.
OcclusionPoint in_widest_gap(const OcclusionPoints& points);

}  // namespace shvr::ui
