#pragma once
// The curve that maps arriving light to displayed light, edited by hand: points in a square with x and y from 0 to 1.
// Pure; any thread.

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "engine/look/settings.h"

namespace shvr::ui {

using OcclusionPoints = std::vector<OcclusionPoint>;

/// Converts the curve of a power to points, as a start for editing.
OcclusionPoints points_of_power(double power);
/// Returns the nearest point within `reach`, which is a distance along each axis.
std::optional<size_t> point_under(const OcclusionPoints& points, const glm::dvec2& place, const glm::dvec2& reach);
/// Moves a point within the square and between its neighbours, so that its index stays the same.
OcclusionPoints moved(OcclusionPoints points, size_t point, const OcclusionPoint& to);
/// Returns the index of the new point. Changes nothing if there are MAX_OCCLUSION_POINTS already.
size_t add(OcclusionPoints& points, const OcclusionPoint& point);
/// Removes a point; keeps at least two.
OcclusionPoints without(OcclusionPoints points, size_t point);
/// Returns the point on the curve in the middle of the widest gap between points.
OcclusionPoint in_widest_gap(const OcclusionPoints& points);

}  // namespace shvr::ui
