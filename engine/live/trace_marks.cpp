#include "engine/live/trace_marks.h"

#include <algorithm>

namespace shvr {

namespace {

/// The internodes around a node, sorted by their number of steps from it.
std::vector<uint32_t> links_about(const TraceGraph& trace, uint32_t node, size_t most)
{
    std::vector<uint32_t> links, nodes{node};
    for (size_t next = 0; next < nodes.size() && links.size() < most; ++next)
        for (const uint32_t number : trace.internodes_of(nodes[next])) {
            if (links.size() == most || std::ranges::find(links, number) != links.end()) continue;
            links.push_back(number);
            nodes.push_back(trace.internode(number).other(nodes[next]));
        }
    return links;
}

}  // namespace

TraceMarks trace_marks(const TraceGraph& trace, std::optional<uint32_t> nearby, double min_radius,
                       const std::optional<glm::dvec3>& moved_to, size_t shown_links)
{
    TraceMarks marks;
    const auto add_ball = [&](const glm::dvec3& at, double radius, const glm::dvec3& color) {
        if (marks.balls.size() < MAX_MARKS) marks.balls.push_back({at, std::max(radius, min_radius), color});
    };
    const TraceSelection& selected = trace.selection();
    if (nearby) add_ball(trace.node(*nearby).position, trace.node(*nearby).radius, NEARBY_COLOR);
    for (const uint32_t number : selected.internodes) {
        if (marks.lines.size() == MAX_MARKS) break;
        const TraceInternode& internode = trace.internode(number);
        marks.lines.push_back({trace.node(internode.a).position, trace.node(internode.b).position, SELECTED_COLOR});
    }
    const bool is_moved = moved_to && selected.node();
    if (selected.node() && !is_moved)
        for (const uint32_t number : links_about(trace, *selected.node(), shown_links)) {
            const TraceInternode& internode = trace.internode(number);
            marks.lines.push_back({trace.node(internode.a).position, trace.node(internode.b).position, LINKED_COLOR});
        }
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
