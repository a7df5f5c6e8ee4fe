#pragma once
// A frame graph as text: for people (Graphviz) and for programs (JSON). Both show what was declared and what compile()
// made of it: culled passes, barriers, lifetimes. Any thread may call these.

#include <string>

#include "engine/graph/frame_graph.h"

namespace shvr {

/// A step's barrier as people read it: "compute -> transfer", with "(order only)" where no memory moves.
std::string to_text(const Barrier& barrier);

/// For `dot`: boxes are passes, in order of execution; ellipses are resources, double-lined where they outlive the
/// frame; what was culled is dashed and grey. A box names the barrier in front of it.
std::string to_graphviz(const FrameGraph& graph, const CompiledGraph& compiled);

/// {"passes": [...], "resources": [...]}; README.md lists the keys.
std::string to_json_text(const FrameGraph& graph, const CompiledGraph& compiled);

}  // namespace shvr
