#pragma once
// Makes the operations on the trace that keys, menus and buttons stand for; scripts use the same operations. Pure; main
// thread only, while the model exists.

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/touch/stylus_motion.h"

namespace shvr::ui {

/// Returns the operation that adds a node at the probe, in the active group and linked with the selected node.
NodeOp node_at_probe(const Model& model);
/// Like node_at_probe(), but if the tools snap to an existing node, links the selected node to that node or, if they
/// are linked already, selects it; if the tools snap to a centre line, adds a node that divides the line.
Action node_or_link_at_probe(const Model& model);
/// Returns the operation to use instead of adding a node if the tools snap to part of the trace; null if they do not.
std::optional<Action> trace_op_at(const ToolPlace& place, const TraceGraph& trace, const glm::dvec3& spacing);
/// Returns the selection of the nearest node or, if that node is selected already, of its nearest internode.
SelectOp nearest_selection(const Model& model);
/// Returns the operation that links the selected node with the node nearest to it.
LinkOp link_with_nearest(const Model& model);

/// Moves the selected node to the probe; of several selected parts, moves the nearest node there and the rest along.
MoveOp move_to_probe(const Model& model);

/// Gives the selected nodes their mean radius times `factor`. If no node is selected, scales all internodes of the
/// selected internode's group or, without a selection, of the active group; these internodes then no longer taper.
RadiusOp scaled(const Model& model, double factor);
/// Gives all nodes of the active group the same radius: the mean of their radii, times `factor`.
RadiusOp scaled_nodes_of_group(const Model& model, double factor);

/// Returns the centre of the selection's bounding box, in volume space; no value if nothing is selected.
std::optional<glm::dvec3> middle_of_selection(const TraceGraph& trace);

}  // namespace shvr::ui
