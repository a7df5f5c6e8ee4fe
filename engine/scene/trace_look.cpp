#include "engine/scene/trace_look.h"

#include <algorithm>

namespace shvr {

std::vector<SurfaceLook> surfaces_of(const TraceGraph& trace, const Groups& groups, const glm::dvec3& spacing)
{
    const double least = 0.5 * std::min({spacing.x, spacing.y, spacing.z});
    const auto shown = [least](double radius) { return radius > 0.0 ? radius : least; };
    std::vector<SurfaceLook> surfaces;
    surfaces.reserve(trace.nodes().size() + trace.internodes().size());
    for (const auto& [number, node] : trace.nodes()) {
        const ColorGroup group = group_of(groups, node.group);
        const double radius = shown(node.radius);
        if (group.visible)
            surfaces.push_back({.from = node.position,
                                .to = node.position,
                                .radius_from = radius,
                                .radius_to = radius,
                                .color = group.color});
    }
    for (const auto& [number, internode] : trace.internodes()) {
        const ColorGroup group = group_of(groups, internode.group);
        if (!group.visible) continue;
        surfaces.push_back({.from = trace.node(internode.a).position,
                            .to = trace.node(internode.b).position,
                            .radius_from = shown(trace.radius_of(internode, 0.0)),
                            .radius_to = shown(trace.radius_of(internode, 1.0)),
                            .color = group.color});
    }
    return surfaces;
}

void show_surfaces(Renderer& renderer, std::vector<SurfaceLook> surfaces, const TraceGraph& trace, const Groups& groups)
{
    const std::vector<SurfaceLook> of_trace = surfaces_of(trace, groups, renderer.volume().info().spacing);
    surfaces.insert(surfaces.end(), of_trace.begin(), of_trace.end());
    renderer.set_surfaces(surfaces);
}

}  // namespace shvr
