#pragma once
// Combines both eyes' pictures into one, for glasses with a red left and a cyan right side (shaders/anaglyph.comp).

#include "engine/graph/frame_graph.h"

namespace shvr {

/// Writes `size` pixels of `color`, starting at texel `target`; `left` and `right` have the same size. All are
/// rgba32_float, linear light. Returns the new version of `color`.
Resource anaglyph(FrameGraph& graph, Resource left, Resource right, Resource color, const glm::uvec2& size,
                  const glm::uvec2& target);

}  // namespace shvr
