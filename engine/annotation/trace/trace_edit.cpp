#include "engine/annotation/trace/trace_edit.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "engine/base/error.h"

namespace shvr {

namespace {

uint32_t take_number(uint64_t next, const char* what)
{
    if (next >> 32 != 0) fail("no number is left for another ", what, "; expected fewer than 4294967296 ever added");
    return uint32_t(next);
}

uint32_t selected_node(const TraceGraph& trace)
{
    const std::optional<uint32_t> node = trace.selection().node();
    if (!node) fail(trace.selection().empty() ? "nothing is selected" : "no node is selected", "; expected a node");
    return *node;
}

const TraceSelection& selected(const TraceGraph& trace)
{
    if (trace.selection().empty()) fail("nothing is selected; expected a node, an internode or a segment");
    return trace.selection();
}

/// Puts one record before the changes, which clears the selection, and one after the changes, which sets it.
std::vector<TraceChange> with_selection(const TraceGraph& trace, std::vector<TraceChange> changes,
                                        TraceSelection selection)
{
    changes.insert(changes.begin(), TraceSelectionChange{trace.selection(), {}});
    changes.emplace_back(TraceSelectionChange{{}, std::move(selection)});
    return changes;
}

template <class Numbers>
std::vector<TraceChange> set_radii(const TraceGraph& trace, const Numbers& nodes, double radius)
{
    std::vector<TraceChange> changes;
    for (const uint32_t number : nodes) {
        const TraceNode& before = trace.node(number);
        TraceNode after = before;
        after.radius = radius;
        if (after != before) changes.emplace_back(TraceNodeChange{number, before, after});
    }
    return changes;
}

}  // namespace

std::vector<TraceChange> add_node(const TraceGraph& trace, const TraceNode& node)
{
    const uint32_t number = take_number(trace.next_node(), "node");
    std::vector<TraceChange> changes{TraceNodeChange{number, {}, node}};
    if (const std::optional<uint32_t> from = trace.selection().node())
        changes.emplace_back(TraceInternodeChange{
            take_number(trace.next_internode(), "internode"), {}, TraceInternode{*from, number, node.group}});
    return with_selection(trace, std::move(changes), {{number}, {}});
}

std::vector<TraceChange> divide_internode(const TraceGraph& trace, uint32_t internode, const TraceNode& node)
{
    const TraceInternode& divided = trace.internode(internode);
    const uint32_t number = take_number(trace.next_node(), "node");
    std::vector<TraceChange> changes{TraceInternodeChange{internode, divided, {}}, TraceNodeChange{number, {}, node}};
    uint64_t next = trace.next_internode();
    const auto link = [&](uint32_t from, uint32_t to, uint8_t group) {
        changes.emplace_back(
            TraceInternodeChange{take_number(next++, "internode"), {}, TraceInternode{from, to, group}});
    };
    link(divided.a, number, divided.group);
    link(number, divided.b, divided.group);
    const std::optional<uint32_t> from = trace.selection().node();
    if (from && *from != divided.a && *from != divided.b) link(*from, number, trace.node(*from).group);
    return with_selection(trace, std::move(changes), {{number}, {}});
}

std::vector<TraceChange> link_selected(const TraceGraph& trace, uint32_t to)
{
    const uint32_t from = selected_node(trace);
    if (from == to) fail("node ", to, " cannot be linked to itself; expected another node");
    if (trace.internode_between(from, to))
        fail("nodes ", from, " and ", to, " are already linked; expected two that are not");
    return {TraceInternodeChange{
        take_number(trace.next_internode(), "internode"), {}, TraceInternode{from, to, trace.node(from).group}}};
}

std::vector<TraceChange> move_selected(const TraceGraph& trace, const glm::dvec3& position)
{
    const uint32_t number = selected_node(trace);
    TraceNode after = trace.node(number);
    if (after.position == position) return {};
    after.position = position;
    return {TraceNodeChange{number, trace.node(number), after}};
}

std::set<uint32_t> nodes_of_selection(const TraceGraph& trace)
{
    const TraceSelection& selection = trace.selection();
    std::set<uint32_t> nodes(selection.nodes.begin(), selection.nodes.end());
    if (!nodes.empty()) return nodes;
    for (const uint32_t number : selection.internodes) {
        nodes.insert(trace.internode(number).a);
        nodes.insert(trace.internode(number).b);
    }
    return nodes;
}

std::vector<TraceChange> shift_selected(const TraceGraph& trace, const glm::dvec3& by)
{
    static_cast<void>(selected(trace));
    std::vector<TraceChange> changes;
    for (const uint32_t number : nodes_of_selection(trace)) {
        TraceNode after = trace.node(number);
        after.position += by;
        if (after != trace.node(number)) changes.emplace_back(TraceNodeChange{number, trace.node(number), after});
    }
    return changes;
}

std::vector<TraceChange> delete_selected(const TraceGraph& trace)
{
    const TraceSelection& selection = selected(trace);
    std::set<uint32_t> internodes(selection.internodes.begin(), selection.internodes.end());
    for (const uint32_t node : selection.nodes)
        for (const uint32_t number : trace.internodes_of(node)) internodes.insert(number);
    std::vector<TraceChange> changes;
    for (const uint32_t number : internodes)
        changes.emplace_back(TraceInternodeChange{number, trace.internode(number), {}});
    for (const uint32_t number : selection.nodes) changes.emplace_back(TraceNodeChange{number, trace.node(number), {}});
    return with_selection(trace, std::move(changes), {});
}

std::vector<TraceChange> set_group_of_selected(const TraceGraph& trace, uint8_t group)
{
    std::vector<TraceChange> changes;
    for (const uint32_t number : selected(trace).nodes) {
        TraceNode after = trace.node(number);
        if (std::exchange(after.group, group) != group)
            changes.emplace_back(TraceNodeChange{number, trace.node(number), after});
    }
    for (const uint32_t number : trace.selection().internodes) {
        TraceInternode after = trace.internode(number);
        if (std::exchange(after.group, group) != group)
            changes.emplace_back(TraceInternodeChange{number, trace.internode(number), after});
    }
    return changes;
}

std::vector<TraceChange> set_radius_of_selected(const TraceGraph& trace, double radius)
{
    if (selected(trace).nodes.empty())
        fail("only internodes are selected, which have no size of their own; expected a node, or the size of a group");
    return set_radii(trace, trace.selection().nodes, radius);
}

std::vector<TraceChange> set_node_radii(const TraceGraph& trace, uint8_t group, double radius)
{
    std::vector<uint32_t> numbers;
    for (const auto& [number, node] : trace.nodes())
        if (node.group == group) numbers.push_back(number);
    return set_radii(trace, numbers, radius);
}

std::vector<TraceChange> set_internode_radius(const TraceGraph& trace, uint8_t group, std::optional<double> radius)
{
    const auto found = trace.internode_radii().find(group);
    const std::optional<double> before =
        found == trace.internode_radii().end() ? std::nullopt : std::optional(found->second);
    if (before == radius) return {};
    return {TraceSizeChange{group, before, radius}};
}

std::optional<uint32_t> nearest_node_of(const TraceGraph& trace, const std::bitset<256>& groups,
                                        const glm::dvec3& position, double reach, std::optional<uint32_t> except)
{
    const auto distance_of = [&](uint32_t node) { return glm::distance(trace.node(node).position, position); };
    if (groups.all()) {
        const std::optional<uint32_t> node = trace.nearest_node(position, except);
        return node && distance_of(*node) <= reach ? node : std::nullopt;
    }
    std::optional<uint32_t> nearest;
    double least = reach;
    const auto take = [&](uint32_t number) {
        const double away = distance_of(number);
        if (number == except || !groups[trace.node(number).group] || away > least || (nearest && away == least)) return;
        nearest = number;
        least = away;
    };
    if (std::isfinite(reach)) {
        for (const uint32_t number : trace.nodes_within(position, reach)) take(number);
    } else {
        for (const auto& [number, node] : trace.nodes()) take(number);
    }
    return nearest;
}

TraceSelection nearest_node_selection(const TraceGraph& trace, const glm::dvec3& position,
                                      const std::bitset<256>& groups)
{
    const std::optional<uint32_t> node =
        nearest_node_of(trace, groups, position, std::numeric_limits<double>::infinity());
    if (!node && !trace.nodes().empty())
        fail("all nodes of the trace are in hidden groups; expected one to select: show a group, or feel hidden parts");
    if (!node) fail("the trace has no nodes; expected one to select");
    return {{*node}, {}};
}

TraceSelection nearest_internode_selection(const TraceGraph& trace, const glm::dvec3& position,
                                           const std::bitset<256>& groups)
{
    const uint32_t node = selected_node(trace);
    const std::span<const uint32_t> all = trace.internodes_of(node);
    if (all.empty()) fail("node ", node, " has no internodes; expected one to select");
    std::vector<uint32_t> internodes(all.begin(), all.end());
    std::erase_if(internodes, [&](uint32_t number) { return !groups[trace.internode(number).group]; });
    if (internodes.empty())
        fail("all internodes of node ", node, " are in hidden groups; expected one to select: show a group, or feel ",
             "hidden parts");
    const auto away = [&](uint32_t number) { return distance_to(trace, trace.internode(number), position); };
    return {{}, {*std::ranges::min_element(internodes, {}, away)}};
}

TraceSelection segment_selection(const TraceGraph& trace)
{
    if (const std::optional<uint32_t> internode = trace.selection().internode())
        return selection_of(trace, segment_through(trace, *internode));
    const uint32_t node = selected_node(trace);
    const std::span<const uint32_t> internodes = trace.internodes_of(node);
    if (internodes.empty()) fail("node ", node, " has no internodes; expected one on a segment");
    if (internodes.size() > 2)
        fail("node ", node, " is a branch of ", internodes.size(),
             " internodes; expected a node on one segment, or an internode");
    return selection_of(trace, segment_through(trace, internodes[0]));
}

}  // namespace shvr
