#pragma once
// Edits of a trace, as records for `History::perform`. Each function reads the trace and its selection and returns
// the records of the edit (none if nothing would change), without changing the trace. Edits that add objects select
// them, so that tracing continues from there; undo restores the earlier selection.
//
// An impossible edit fails with a message, such as "nothing is selected; expected a node". Any thread may call
// these.

#include <bitset>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "engine/annotation/trace/trace_segments.h"

namespace shvr {

/// Adds a node. Joins it to the selected node, if there is one, by an internode of the new node's group.
std::vector<TraceChange> add_node(const TraceGraph& trace, const TraceNode& node);
/// Splits an internode into two of its group that meet in the new node. If another node is selected that is not an end
/// of the internode, joins it to the new node by an internode of the selected node's group.
std::vector<TraceChange> divide_internode(const TraceGraph& trace, uint32_t internode, const TraceNode& node);
/// Joins the selected node to another node by an internode of the selected node's group, and keeps the selection.
std::vector<TraceChange> link_selected(const TraceGraph& trace, uint32_t to);
std::vector<TraceChange> move_selected(const TraceGraph& trace, const glm::dvec3& position);
/// The selected nodes or, if there are none, the ends of the selected internodes. If a segment is selected, leaves out
/// the branches at its ends, because they also belong to other segments.
std::set<uint32_t> nodes_of_selection(const TraceGraph& trace);
/// Moves the nodes of `nodes_of_selection` by the same vector.
std::vector<TraceChange> shift_selected(const TraceGraph& trace, const glm::dvec3& by);
/// Deletes the selection: a node with its internodes, an internode, or a segment (its internodes, and its nodes except
/// branches).
std::vector<TraceChange> delete_selected(const TraceGraph& trace);
std::vector<TraceChange> set_group_of_selected(const TraceGraph& trace, uint8_t group);
/// Sets the radius of the selected node, or of all nodes of the segment. Fails for an internode: it has no own radius.
std::vector<TraceChange> set_radius_of_selected(const TraceGraph& trace, double radius);

/// Sets the radius of all nodes of a group.
std::vector<TraceChange> set_node_radii(const TraceGraph& trace, uint8_t group, double radius);
/// Sets the radius of all internodes of a group; null: their radius tapers from node to node.
std::vector<TraceChange> set_internode_radius(const TraceGraph& trace, uint8_t group, std::optional<double> radius);

inline const std::bitset<256> EVERY_GROUP = std::bitset<256>().set();
/// The node of these groups that is nearest to a position and at most `reach` away; null if there is none. Without a
/// `reach`, visits the whole trace unless all groups are searched.
std::optional<uint32_t> nearest_node_of(const TraceGraph& trace, const std::bitset<256>& groups,
                                        const glm::dvec3& position,
                                        double reach = std::numeric_limits<double>::infinity(),
                                        std::optional<uint32_t> except = {});
/// The argument of `TraceGraph::select`.
TraceSelection nearest_node_selection(const TraceGraph& trace, const glm::dvec3& position,
                                      const std::bitset<256>& groups = EVERY_GROUP);
/// Selects the nearest internode of the selected node, even if an internode of another node is nearer.
TraceSelection nearest_internode_selection(const TraceGraph& trace, const glm::dvec3& position,
                                           const std::bitset<256>& groups = EVERY_GROUP);
/// The segment of the selected internode, or of the selected node if it lies on one segment only.
TraceSelection segment_selection(const TraceGraph& trace);

}  // namespace shvr
