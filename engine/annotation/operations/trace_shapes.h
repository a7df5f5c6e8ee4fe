#pragma once
// The shape of a trace in volume space: a ball for each node, and for each internode the convex hull of the two balls
// at its ends, a cone tangent to both.

#include <span>
#include <vector>

#include "engine/annotation/trace/tracing.h"

namespace shvr {

/// The convex hull of two balls: every point within `a_radius + t (b_radius - a_radius)` of `a + t (b - a)`, for some t
/// in [0, 1]. For a node, the two balls are the same.
struct TraceShape {
    glm::dvec3 a{0.0}, b{0.0};
    double a_radius = 0.0, b_radius = 0.0;
    /// Whether a point is inside, or outside by at most `margin`; up to a relative error of 5e-10 of the radius.
    bool contains(const glm::dvec3& point, double margin = 0.0) const;
};

/// Shapes of the nodes and internodes of some groups (empty: of all groups), with the radii that are drawn.
std::vector<TraceShape> shapes_of(const TraceGraph& trace, std::span<const uint8_t> groups);

}  // namespace shvr
