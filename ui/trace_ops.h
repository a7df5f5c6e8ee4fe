#pragma once
// What a person means by a key, a menu or a button of tracing, as operations that scripts have, too. Pure; the main
// thread, while the model lives.

#include "ui/action.h"
#include "ui/model.h"

namespace shvr::ui {

/// At the probe, of its size and group; linked with the selected node.
TraceOp node_at_probe(const Model& model);
/// The nearest node; where that is selected already, the nearest of its internodes.
TraceOp nearest_selection(const Model& model);
/// The selected node with the nearest other one.
TraceOp link_with_nearest(const Model& model);

/// Which sizes the keys change: those of selected nodes, or with nothing selected those of all internodes of the chosen
/// group, which then no longer taper.
RadiusOp scaled(const Model& model, double factor);
/// All nodes of the chosen group get one size: their mean, times the factor.
RadiusOp scaled_nodes_of_group(const Model& model, double factor);

}  // namespace shvr::ui
