#pragma once
// Mixes two pictures (shaders/picture/mix.comp).

#include "engine/graph/frame_graph.h"
#include "shaders/mix.h"

namespace shvr {

/// Blends `other` into a part of `color`, in place; `other` has the part's size. Both are rgba32_float, linear light,
/// premultiplied. Returns the new version of `color`.
Resource mix(FrameGraph& graph, Resource other, Resource color, const gpu::MixParams& params);

}  // namespace shvr
