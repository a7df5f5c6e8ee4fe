#include "engine/annotation/operations/trace_shapes.h"

#include <algorithm>
#include <bitset>

namespace shvr {

// With c = from_a, l = way, s = gain and r(t) = radius + t s, the point is inside if f(t) = |c - t l|^2 - r(t)^2 is at
// most 0 for some t in [0, 1]. Since f is a parabola, its minimum there is at its vertex or at an end of the interval.
// If |l| <= |s|, one ball contains the other, so only the larger ball is tested.
bool TraceShape::contains(const glm::dvec3& point, double margin) const
{
    const glm::dvec3 from_a = point - a, way = b - a;
    const double radius = a_radius + margin, gain = b_radius - a_radius;
    const double curve = glm::dot(way, way) - gain * gain, slope = glm::dot(from_a, way) + radius * gain;
    double t = gain > 0.0 ? 1.0 : 0.0;
    if (curve > 0.0) t = std::clamp(slope / curve, 0.0, 1.0);
    const glm::dvec3 away = from_a - t * way;
    const double reach = radius + t * gain;
    return glm::dot(away, away) <= reach * reach * (1.0 + 1e-9);
}

std::vector<TraceShape> shapes_of(const TraceGraph& trace, std::span<const uint8_t> groups)
{
    std::bitset<256> chosen;
    for (const uint8_t group : groups) chosen[group] = true;
    if (groups.empty()) chosen.set();
    std::vector<TraceShape> shapes;
    for (const auto& [number, node] : trace.nodes())
        if (chosen[node.group]) shapes.push_back({node.position, node.position, node.radius, node.radius});
    for (const auto& [number, internode] : trace.internodes()) {
        if (!chosen[internode.group]) continue;
        shapes.push_back({trace.node(internode.a).position, trace.node(internode.b).position,
                          trace.radius_of(internode, 0.0), trace.radius_of(internode, 1.0)});
    }
    return shapes;
}

}  // namespace shvr
