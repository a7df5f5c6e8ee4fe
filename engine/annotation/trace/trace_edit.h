#pragma once
// What a person does to a trace, as records that `History::perform` applies: each function looks at the trace and at what
// is selected in it, changes nothing, and returns what is to change (nothing, where all is that way already). Commands
// that add select what they added, so that tracing goes on from there; undoing brings the earlier selection back.
//
// What cannot be done fails with a sentence ("nothing is selected; expected a node"). Any thread may call these.

#include <vector>

#include "engine/annotation/trace/trace_segments.h"

namespace shvr {

/// Joined to the selected node where one is, by an internode of the new node's group.
std::vector<TraceChange> add_node(const TraceGraph& trace, const TraceNode& node);
/// Joins the selected node to another by an internode of the selected node's group. The node stays selected.
std::vector<TraceChange> link_selected(const TraceGraph& trace, uint32_t to);
std::vector<TraceChange> move_selected(const TraceGraph& trace, const glm::dvec3& position);
/// The selected node with its internodes, the selected internode, or the segment: its internodes, and its nodes that are
/// no branch.
std::vector<TraceChange> delete_selected(const TraceGraph& trace);
std::vector<TraceChange> set_group_of_selected(const TraceGraph& trace, uint8_t group);
/// Of the selected node or of the nodes of the segment. An internode alone has no size of its own.
std::vector<TraceChange> set_radius_of_selected(const TraceGraph& trace, double radius);

/// Of all nodes of a group.
std::vector<TraceChange> set_node_radii(const TraceGraph& trace, uint8_t group, double radius);
/// Of all internodes of a group; nothing: they taper from node to node.
std::vector<TraceChange> set_internode_radius(const TraceGraph& trace, uint8_t group, std::optional<double> radius);

/// What `TraceGraph::select` takes.
TraceSelection nearest_node_selection(const TraceGraph& trace, const glm::dvec3& position);
/// The nearest of the selected node's internodes: of many that lie close, a person means one of the node at hand.
TraceSelection nearest_internode_selection(const TraceGraph& trace, const glm::dvec3& position);
/// The segment of the selected internode, or of the selected node where it lies on one only.
TraceSelection segment_selection(const TraceGraph& trace);

}  // namespace shvr
