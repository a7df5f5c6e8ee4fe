#pragma once
// Converts the keys, menus and buttons of tracing to operations; scripts use the same operations. Pure; main thread
// only, while the model exists.

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/touch/stylus_motion.h"

namespace shvr::ui {

/// Returns the operation that adds a node at the probe, with its group and default radius, linked to the selected node.
NodeOp node_at_probe(const Model& model);
/// Returns the operation of node_at_probe(), with two exceptions. If tools act at an existing node, links the selected
/// node with it or, if these are linked already, selects it. On a centre line, adds a node that divides the line.
Action node_or_link_at_probe(const Model& model);
/// Returns the operation that replaces adding a node if part of the trace attracts the tools; null if nothing does.
std::optional<Action> trace_op_at(const ToolPlace& place, const TraceGraph& trace, const glm::dvec3& spacing);
/// Selects the nearest node or, if that node is selected already, its nearest internode.
SelectOp nearest_selection(const Model& model);
/// Links the selected node with the nearest other node.
LinkOp link_with_nearest(const Model& model);

/// Moves the selected node to the probe. If several parts are selected, moves all so that the nearest node gets there.
MoveOp move_to_probe(const Model& model);

/// Scales the radii of the selected nodes or, if none is selected, of all internodes of the chosen group; these
/// internodes then no longer taper.
RadiusOp scaled(const Model& model, double factor);
/// Gives all nodes of the chosen group the same radius: their mean, times `factor`.
RadiusOp scaled_nodes_of_group(const Model& model, double factor);

/// Returns the centre of the selection's bounding box, in volume space; no value if nothing is selected.
std::optional<glm::dvec3> middle_of_selection(const TraceGraph& trace);

}  // namespace shvr::ui
