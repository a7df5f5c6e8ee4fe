#pragma once
// Brushes on a region of the volume: which voxels would they paint? The answer is one bit per voxel of the region, the
// same for preview, painting and test. A fixed number of passes, whatever the shape of what is in the region.

#include <span>

#include "engine/passes/volume_binding.h"
#include "shaders/paint.h"

namespace shvr {

struct RegionInput {
    gpu::RegionParams params;            ///< but for the bricks
    const RegionBricks& bricks;          ///< those that the region lies in
    std::span<const gpu::RowSpan> rows;  ///< params.size.y * params.size.z, y fastest
};

/// Every voxel at or above the threshold.
Resource select_fill(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);
/// Those connected to the seed.
Resource select_flood(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);
/// The components that hold no edge voxel of the region.
Resource select_speckles(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);

}  // namespace shvr
