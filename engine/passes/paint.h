#pragma once
// Brushes on a region of the volume: which voxels do they select, by density? The answer is one bit per voxel of the
// region, the same for preview, painting and tests; who may have them is decided where the mask is
// (engine/annotation/painting.h). The number of passes is fixed, whatever the region contains.

#include <span>

#include "engine/passes/volume_binding.h"
#include "shaders/regions/regions.h"

namespace shvr {

struct RegionInput {
    gpu::RegionParams params;            ///< all but the bricks
    const RegionBricks& bricks;          ///< the bricks that the region overlaps
    std::span<const gpu::RowSpan> rows;  ///< params.size.y * params.size.z, y fastest
};

/// Every voxel at or above the threshold.
Resource select_fill(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);
/// Those connected to the seed, among the voxels at or above the threshold.
Resource select_flood(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);
/// The components without a voxel at the region's edge.
Resource select_speckles(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);

/// Some brush is likely to be used before long.
void expect_brushes(FrameGraph& graph, const VolumeBinding& volume);

/// Bits of a box of voxels, laid out as a region's, that need not lie in it.
struct SeedBits {
    Resource words;
    glm::uvec3 size{0};  ///< voxels
    uint32_t words_per_row = 0;
    glm::ivec3 from_region{0};  ///< the region's lower corner less that of this box
};
/// Of `mask`, bits of a region of any level (`params`: size, words and connectivity), the components that hold a seed.
Resource select_object(FrameGraph& graph, const gpu::RegionParams& params, Resource mask, const SeedBits& seeds);

}  // namespace shvr
