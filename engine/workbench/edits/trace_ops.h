#pragma once
// Turns the keys, menus and buttons of tracing into operations, the same ones that scripts use. Pure; the main thread,
// while the model lives.

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"
#include "engine/workbench/touch/stylus_motion.h"

namespace shvr::ui {

/// A node at the probe, of the probe's group and as wide as new nodes are, linked to the selected node.
NodeOp node_at_probe(const Model& model);
/// The same; at a node that the tool acts at, a link of the selected node with it or, where that is there, its choice;
/// on a centre line, a node that divides it.
Action node_or_link_at_probe(const Model& model);
/// What a new node becomes where something of the trace draws the tools; null where nothing does.
std::optional<Action> trace_op_at(const ToolPlace& place, const TraceGraph& trace, const glm::dvec3& spacing);
/// Selects the nearest node or, if that is selected already, the nearest of its internodes.
SelectOp nearest_selection(const Model& model);
/// Links the selected node to the nearest other one.
LinkOp link_with_nearest(const Model& model);

/// Scales the radii of the selected nodes or, if none is selected, of all internodes of the chosen group, which then no
/// longer taper.
RadiusOp scaled(const Model& model, double factor);
/// Gives all nodes of the chosen group the same radius: their mean, times the factor.
RadiusOp scaled_nodes_of_group(const Model& model, double factor);

/// The middle of the box around what is selected, volume space; nothing where nothing is.
std::optional<glm::dvec3> middle_of_selection(const TraceGraph& trace);

}  // namespace shvr::ui
