#include "engine/live/trace_marks.h"

#include <algorithm>
#include <set>

#include "engine/annotation/trace/trace_edit.h"

namespace shvr {

namespace {

/// Returns at most `most` internodes near a node, sorted by their distance from the node in internodes.
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
                       const std::optional<glm::dvec3>& moved_by, size_t shown_links)
{
    TraceMarks marks;
    const auto add_ball = [&](const glm::dvec3& at, double radius, const glm::dvec3& color) {
        if (marks.balls.size() < MAX_MARKS) marks.balls.push_back({at, std::max(radius, min_radius), color});
    };
    const TraceSelection& selected = trace.selection();
    const std::set<uint32_t> moved = moved_by ? nodes_of_selection(trace) : std::set<uint32_t>();
    const auto place_of = [&](uint32_t node) {
        const glm::dvec3& position = trace.node(node).position;
        return moved.contains(node) ? position + *moved_by : position;
    };
    const auto add_line = [&](uint32_t number, const glm::dvec3& color) {
        const TraceInternode& internode = trace.internode(number);
        if (marks.lines.size() < MAX_MARKS)
            marks.lines.push_back({place_of(internode.a), place_of(internode.b), color});
    };
    if (nearby) add_ball(trace.node(*nearby).position, trace.node(*nearby).radius, NEARBY_COLOR);
    // Internodes at a dragged node follow it.
    std::set<uint32_t> links;
    for (const uint32_t node : moved)
        for (const uint32_t number : trace.internodes_of(node)) links.insert(number);
    for (const uint32_t number : links) add_line(number, SELECTED_COLOR);
    for (const uint32_t number : selected.internodes) {
        if (!moved.empty() || marks.lines.size() == MAX_MARKS) break;  // moved ones are already among `links`
        add_line(number, SELECTED_COLOR);
    }
    if (selected.node() && !moved_by)
        for (const uint32_t number : links_about(trace, *selected.node(), shown_links)) add_line(number, LINKED_COLOR);
    for (const uint32_t node : selected.nodes) add_ball(place_of(node), trace.node(node).radius, SELECTED_COLOR);
    return marks;
}

}  // namespace shvr
