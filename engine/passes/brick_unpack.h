#pragma once
// Copies a batch of bricks from a buffer to their places in device images (shaders/brick_unpack.comp).

#include <span>

#include "engine/graph/frame_graph.h"
#include "engine/passes/atlas_codes.h"
#include "shaders/brick_unpack.h"

namespace shvr {

/// `atlas`, `codes`, `by_address`, `cell_ranges`: as in VolumeBinding. Returns the new `cell_ranges`.
[[nodiscard]] Resource brick_unpack(FrameGraph& graph, Resource staged, Resource atlas, AtlasCodes codes,
                                    bool by_address, Resource cell_ranges, std::span<const gpu::BrickUnpackJob> jobs);

}  // namespace shvr
