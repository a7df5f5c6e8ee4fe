#pragma once
// A frame graph as text: for people (Graphviz) and for programs (JSON). Both show the declared graph and the result of
// compile(): culled passes, barriers, lifetimes. Any thread may call these.

#include <string>

#include "engine/graph/frame_graph.h"

namespace shvr {

/// A step's barrier as text: "compute -> transfer", with "(order only)" for an execution barrier without memory.
std::string to_text(const Barrier& barrier);

/// For `dot`: boxes are passes in order of execution; ellipses are resources, double-lined if they outlive the frame;
/// culled items are dashed and grey. A box shows the barrier before its pass.
std::string to_graphviz(const FrameGraph& graph, const CompiledGraph& compiled);

/// {"passes": [...], "resources": [...]}; README.md lists the keys.
std::string to_json_text(const FrameGraph& graph, const CompiledGraph& compiled);

}  // namespace shvr
