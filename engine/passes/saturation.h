#pragma once
// Desaturates a picture (shaders/saturation.comp).

#include "engine/graph/frame_graph.h"
#include "shaders/saturation.h"

namespace shvr {

/// Changes a part of `color` (rgba32_float, linear light, premultiplied) in place; returns its new version.
Resource saturation(FrameGraph& graph, Resource color, const gpu::SaturationParams& params);

}  // namespace shvr
