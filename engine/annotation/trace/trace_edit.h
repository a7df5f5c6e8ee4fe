#pragma once
// Edits of a trace, as records for `History::perform`: each function reads the trace and its selection, changes
// nothing, and returns the records of the edit (none if nothing would change). Edits that add objects select them, so
// that tracing continues from there; undoing restores the earlier selection.
//
// An edit that is not possible fails with a sentence ("nothing is selected; expected a node"). Any thread may call
// these.

#include <bitset>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "engine/annotation/trace/trace_segments.h"

namespace shvr {

/// Joins the new node to the selected one, if any, by an internode of the new node's group.
std::vector<TraceChange> add_node(const TraceGraph& trace, const TraceNode& node);
/// Splits an internode of one group into two that meet in the new node. If the selected node is another one, and not an
/// end of the internode, also joins it to the new node by an internode of the selected node's group.
std::vector<TraceChange> divide_internode(const TraceGraph& trace, uint32_t internode, const TraceNode& node);
/// Joins the selected node to another node by an internode of the selected node's group, and keeps the selection.
std::vector<TraceChange> link_selected(const TraceGraph& trace, uint32_t to);
std::vector<TraceChange> move_selected(const TraceGraph& trace, const glm::dvec3& position);
/// The selected nodes or, if there are none, the ends of the selected internodes. If a segment is selected, branches at
/// its ends are left out: they belong to other segments, too, and stay where they are.
std::set<uint32_t> nodes_of_selection(const TraceGraph& trace);
/// Moves the nodes of `nodes_of_selection` by the same vector.
std::vector<TraceChange> shift_selected(const TraceGraph& trace, const glm::dvec3& by);
/// Deletes the selection: a node with its internodes, an internode, or a segment (its internodes, and those of its
/// nodes that are not branches).
std::vector<TraceChange> delete_selected(const TraceGraph& trace);
std::vector<TraceChange> set_group_of_selected(const TraceGraph& trace, uint8_t group);
/// Sets the radius of the selected node, or of the nodes of the segment. A single internode has no radius of its own.
std::vector<TraceChange> set_radius_of_selected(const TraceGraph& trace, double radius);

/// Sets the radius of all nodes of a group.
std::vector<TraceChange> set_node_radii(const TraceGraph& trace, uint8_t group, double radius);
/// Sets the radius of all internodes of a group; without a radius they taper from node to node.
std::vector<TraceChange> set_internode_radius(const TraceGraph& trace, uint8_t group, std::optional<double> radius);

inline const std::bitset<256> EVERY_GROUP = std::bitset<256>().set();
/// The node of these groups that is nearest to a position and at most `reach` away; null if there is none. Without
/// `reach`, it visits the whole trace, unless all groups count.
std::optional<uint32_t> nearest_node_of(const TraceGraph& trace, const std::bitset<256>& groups,
                                        const glm::dvec3& position,
                                        double reach = std::numeric_limits<double>::infinity(),
                                        std::optional<uint32_t> except = {});
/// The argument of `TraceGraph::select`.
TraceSelection nearest_node_selection(const TraceGraph& trace, const glm::dvec3& position,
                                      const std::bitset<256>& groups = EVERY_GROUP);
/// Selects the nearest of the selected node's internodes, even if an internode of another node is nearer.
TraceSelection nearest_internode_selection(const TraceGraph& trace, const glm::dvec3& position,
                                           const std::bitset<256>& groups = EVERY_GROUP);
/// The segment of the selected internode, or of the selected node if it lies on only one.
TraceSelection segment_selection(const TraceGraph& trace);

}  // namespace shvr
