#include "engine/annotation/trace/trace_segments.h"

#include <algorithm>
#include <iterator>

namespace shvr {

namespace {

/// Extends the segment beyond its last node, up to its end or, in a loop, back to its first internode.
void extend(const TraceGraph& trace, const std::set<uint32_t>& stops, TraceSegment& segment)
{
    const uint32_t first = segment.internodes.front();
    for (;;) {
        const uint32_t node = segment.nodes.back();
        const std::span<const uint32_t> links = trace.internodes_of(node);
        if (links.size() != 2 || stops.contains(node)) return;
        const uint32_t next = links[0] == segment.internodes.back() ? links[1] : links[0];
        if (next == first) return;  // a loop, which began at `node`
        segment.internodes.push_back(next);
        segment.nodes.push_back(trace.internode(next).other(node));
    }
}

}  // namespace

TraceSegment segment_through(const TraceGraph& trace, uint32_t internode, const std::set<uint32_t>& stops)
{
    const TraceInternode& start = trace.internode(internode);
    TraceSegment forwards{{start.a, start.b}, {internode}}, backwards{{start.b, start.a}, {internode}};
    extend(trace, stops, forwards);
    if (forwards.is_loop() && trace.internodes_of(start.a).size() == 2 && !stops.contains(start.a)) return forwards;
    extend(trace, stops, backwards);
    TraceSegment whole;
    whole.nodes.assign(backwards.nodes.rbegin(), std::prev(backwards.nodes.rend(), 2));
    whole.internodes.assign(backwards.internodes.rbegin(), std::prev(backwards.internodes.rend()));
    whole.nodes.insert(whole.nodes.end(), forwards.nodes.begin(), forwards.nodes.end());
    whole.internodes.insert(whole.internodes.end(), forwards.internodes.begin(), forwards.internodes.end());
    return whole;
}

std::vector<TraceSegment> segments_of(const TraceGraph& trace, const std::set<uint32_t>& stops)
{
    std::vector<TraceSegment> segments;
    std::set<uint32_t> seen;
    for (const auto& [number, internode] : trace.internodes()) {
        if (seen.contains(number)) continue;
        segments.push_back(segment_through(trace, number, stops));
        seen.insert(segments.back().internodes.begin(), segments.back().internodes.end());
    }
    return segments;
}

TraceSelection selection_of(const TraceGraph& trace, const TraceSegment& segment)
{
    TraceSelection selection{segment.nodes, segment.internodes};
    std::erase_if(selection.nodes, [&](uint32_t node) { return trace.internodes_of(node).size() > 2; });
    std::sort(selection.nodes.begin(), selection.nodes.end());
    selection.nodes.erase(std::unique(selection.nodes.begin(), selection.nodes.end()), selection.nodes.end());
    std::sort(selection.internodes.begin(), selection.internodes.end());
    return selection;
}

double share_along(const TraceGraph& trace, const TraceInternode& internode, const glm::dvec3& position)
{
    const glm::dvec3 a = trace.node(internode.a).position, along = trace.node(internode.b).position - a;
    const double length_squared = glm::dot(along, along);
    return length_squared > 0.0 ? glm::clamp(glm::dot(position - a, along) / length_squared, 0.0, 1.0) : 0.0;
}

std::optional<PlaceOnTrace> nearest_place(const TraceGraph& trace, const glm::dvec3& position, double reach,
                                          std::optional<uint32_t> except_of, const std::bitset<256>& groups)
{
    std::optional<PlaceOnTrace> nearest;
    double least = reach;
    for (const uint32_t node : trace.nodes_within(position, reach + 0.5 * trace.longest_at_most())) {
        for (const uint32_t number : trace.internodes_of(node)) {
            const TraceInternode& internode = trace.internode(number);
            const bool is_excepted = except_of && (internode.a == *except_of || internode.b == *except_of);
            if (is_excepted || !groups[internode.group]) continue;
            const double share = share_along(trace, internode, position);
            const glm::dvec3 place =
                glm::mix(trace.node(internode.a).position, trace.node(internode.b).position, share);
            const double away = glm::distance(place, position);
            const bool is_nearer = away < least || (away == least && (!nearest || number < nearest->internode));
            if (is_nearer) nearest = {number, share, place}, least = away;
        }
    }
    return nearest;
}

double distance_to(const TraceGraph& trace, const TraceInternode& internode, const glm::dvec3& position)
{
    const glm::dvec3 a = trace.node(internode.a).position, along = trace.node(internode.b).position - a;
    return glm::length(position - (a + share_along(trace, internode, position) * along));
}

}  // namespace shvr
