#pragma once
// Brushes on a region of the volume: which voxels do they select, by density? The answer is one bit per voxel of the
// region, the same for preview, painting and tests; which of these may change group is decided next to the mask
// (engine/annotation/painting.h). The number of passes is fixed, whatever the region contains.

#include <span>

#include "engine/passes/volume_binding.h"
#include "shaders/regions/regions.h"

namespace shvr {

struct RegionInput {
    gpu::RegionParams params;            ///< complete except for the bricks
    const RegionBricks& bricks;          ///< the bricks that the region overlaps
    std::span<const gpu::RowSpan> rows;  ///< params.size.y * params.size.z, y fastest
};

/// Selects every voxel at or above the threshold.
Resource select_fill(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);
/// Selects the voxels connected to the seed, among those at or above the threshold.
Resource select_flood(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);
/// Selects the components without a voxel on the region's boundary.
Resource select_speckles(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);

/// The same two brushes where the bits of the region, within its rows, are known already (engine/bricks/
/// threshold_bricks.h).
Resource select_flood_in(FrameGraph& graph, const gpu::RegionParams& params, std::span<const uint32_t> bits);
Resource select_speckles_in(FrameGraph& graph, const gpu::RegionParams& params, std::span<const gpu::RowSpan> rows,
                            std::span<const uint32_t> bits);

/// Hints that a brush is likely to be used soon.
void expect_brushes(FrameGraph& graph, const VolumeBinding& volume);

/// Bits of a box of voxels, in a region's layout; the box need not lie inside the region.
struct SeedBits {
    Resource words;
    glm::uvec3 size{0};  ///< voxels
    uint32_t words_per_row = 0;
    glm::ivec3 from_region{0};  ///< the region's lower corner minus this box's
};
/// Selects, in `mask` (bits of a region of any level; `params`: size, words and connectivity), the components with a
/// seed.
Resource select_object(FrameGraph& graph, const gpu::RegionParams& params, Resource mask, const SeedBits& seeds);

}  // namespace shvr
