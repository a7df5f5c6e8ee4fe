#pragma once
// Converts linear light to the pixel format of a screen (shaders/picture/encode.comp).

#include "engine/graph/frame_graph.h"
#include "shaders/encode.h"

namespace shvr {

/// Writes a part of `display` (rgba8_unorm) from a part of `color` (rgba32_float); returns the new version of
/// `display`.
Resource encode(FrameGraph& graph, Resource color, Resource display, const gpu::EncodeParams& params);

}  // namespace shvr
