#pragma once
// The space that a trace takes up: a ball for each node, and for each internode the convex hull of two balls at its
// ends, a cone tangent to both. Volume space.

#include <span>
#include <vector>

#include "engine/annotation/trace/tracing.h"

namespace shvr {

/// The convex hull of two balls: every point within `a_radius + t (b_radius - a_radius)` of `a + t (b - a)`, for some
/// t of 0 ... 1. A node is such a hull with both balls the same.
struct TraceShape {
    glm::dvec3 a{0.0}, b{0.0};
    double a_radius = 0.0, b_radius = 0.0;
    /// Whether a point is at most `margin` outside. A distance that equals the radius, up to 5e-10 of it, is inside.
    bool contains(const glm::dvec3& point, double margin = 0.0) const;
};

/// The shapes of the nodes and internodes of some groups; internodes have the radii with which they are drawn.
std::vector<TraceShape> shapes_of(const TraceGraph& trace, std::span<const uint8_t> groups);

}  // namespace shvr
