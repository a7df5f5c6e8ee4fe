#pragma once
// Writes a frame graph as text: for people (Graphviz) and for programs (JSON). Both show the declared graph and the
// result of compile(): culled passes, barriers, lifetimes. Any thread may call these functions.

#include <string>

#include "engine/graph/frame_graph.h"

namespace shvr {

/// Describes a barrier: "compute -> transfer", with "(order only)" if it does not synchronise memory.
std::string to_text(const Barrier& barrier);

/// Returns input for `dot`. Boxes are passes in order of execution, each with the barrier before it. Ellipses are
/// resources, with a double line if they outlive the frame. Culled passes and resources are dashed and grey.
std::string to_graphviz(const FrameGraph& graph, const CompiledGraph& compiled);

/// Returns {"passes": [...], "resources": [...]}; README.md lists the keys.
std::string to_json_text(const FrameGraph& graph, const CompiledGraph& compiled);

}  // namespace shvr
