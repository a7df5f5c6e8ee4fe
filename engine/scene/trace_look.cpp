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

namespace {

/// The box around balls.
class Reach {
public:
    void add(const TraceNode& node) { add(node.position, node.radius); }
    void add(const glm::dvec3& position, double radius)
    {
        lower_ = glm::min(lower_, position - radius);
        upper_ = glm::max(upper_, position + radius);
    }
    /// A voxel more on each side: what has no radius is drawn with some.
    VoxelBox box(const glm::dvec3& spacing) const
    {
        if (lower_.x > upper_.x) return {};
        return {Size3(glm::floor(lower_ / spacing)) - int64_t{1}, Size3(glm::ceil(upper_ / spacing)) + int64_t{1}};
    }

private:
    glm::dvec3 lower_{1e300}, upper_{-1e300};
};

}  // namespace

VoxelBox trace_reach(const TraceGraph& trace, std::span<const Change> changes, const glm::dvec3& spacing)
{
    Reach reach;
    double thickest = 0.0;
    for (const auto& [group, radius] : trace.internode_radii()) thickest = std::max(thickest, radius);
    const auto add_node = [&](uint32_t number) {
        const auto found = trace.nodes().find(number);
        if (found == trace.nodes().end()) return;  // its own change tells where it was
        reach.add(found->second);
        reach.add(found->second.position, thickest);
    };
    const auto add_changed = [&](uint32_t number, const std::optional<TraceNode>& node) {
        if (!node) return;
        reach.add(*node);
        reach.add(node->position, thickest);
        if (!trace.nodes().contains(number)) return;
        for (const uint32_t internode : trace.internodes_of(number)) add_node(trace.internode(internode).other(number));
    };
    for (const Change& change : changes) {
        const auto* const of_trace = std::get_if<TraceChange>(&change);
        if (!of_trace) continue;
        if (const auto* node = std::get_if<TraceNodeChange>(of_trace)) {
            add_changed(node->node, node->before);
            add_changed(node->node, node->after);
        } else if (const auto* internode = std::get_if<TraceInternodeChange>(of_trace)) {
            for (const auto& ends : {internode->before, internode->after})
                if (ends) add_node(ends->a), add_node(ends->b);
        } else if (const auto* size = std::get_if<TraceSizeChange>(of_trace)) {
            const double largest = std::max({thickest, size->before.value_or(0.0), size->after.value_or(0.0)});
            for (const auto& [number, any] : trace.nodes()) reach.add(any.position, std::max(largest, any.radius));
        }
    }
    return reach.box(spacing);
}

TraceMarks trace_marks(const TraceGraph& trace, std::optional<uint32_t> nearby, double least_radius,
                       const std::optional<glm::dvec3>& moved_to)
{
    TraceMarks marks;
    const auto add_ball = [&](const glm::dvec3& at, double radius, const glm::dvec3& color) {
        if (marks.balls.size() < MOST_MARKS) marks.balls.push_back({at, std::max(radius, least_radius), color});
    };
    const TraceSelection& selected = trace.selection();
    if (nearby) add_ball(trace.node(*nearby).position, trace.node(*nearby).radius, NEARBY_COLOR);
    for (const uint32_t number : selected.internodes) {
        if (marks.lines.size() == MOST_MARKS) break;
        const TraceInternode& internode = trace.internode(number);
        marks.lines.push_back({trace.node(internode.a).position, trace.node(internode.b).position, SELECTED_COLOR});
    }
    const bool is_moved = moved_to && selected.node();
    for (const uint32_t node : selected.nodes) {
        add_ball(is_moved ? *moved_to : trace.node(node).position, trace.node(node).radius, SELECTED_COLOR);
        if (!is_moved) continue;
        for (const uint32_t number : trace.internodes_of(node))
            marks.lines.push_back(
                {*moved_to, trace.node(trace.internode(number).other(node)).position, SELECTED_COLOR});
    }
    return marks;
}

}  // namespace shvr
