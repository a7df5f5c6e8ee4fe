#pragma once
// Converts the keys, menus and buttons of tracing to operations, the same ones that scripts use. Pure; the main thread,
// while the model lives.

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/touch/stylus_motion.h"

namespace shvr::ui {

/// Returns a new node at the probe, with the probe's group and the default radius, linked to the selected node.
NodeOp node_at_probe(const Model& model);
/// Returns the same node. If tools act at an existing node, returns instead a link of the selected node with it or, if
/// they are linked, its selection; on a centre line, a node that divides it.
Action node_or_link_at_probe(const Model& model);
/// Returns the operation in place of a new node if part of the trace attracts the tools; null if none does.
std::optional<Action> trace_op_at(const ToolPlace& place, const TraceGraph& trace, const glm::dvec3& spacing);
/// Selects the nearest node or, if it is selected already, the nearest of its internodes.
SelectOp nearest_selection(const Model& model);
/// Links the selected node with the nearest other one.
LinkOp link_with_nearest(const Model& model);

/// Moves the selected node to the probe; several parts together, so that the nearest of their nodes is at the probe.
MoveOp move_to_probe(const Model& model);

/// Scales the radii of the selected nodes or, if none is selected, of all internodes of the chosen group, which then no
/// longer taper.
RadiusOp scaled(const Model& model, double factor);
/// Gives all nodes of the chosen group the same radius: their mean, times `factor`.
RadiusOp scaled_nodes_of_group(const Model& model, double factor);

/// Returns the centre of the selection's bounding box, in volume space; nothing if nothing is selected.
std::optional<glm::dvec3> middle_of_selection(const TraceGraph& trace);

}  // namespace shvr::ui
