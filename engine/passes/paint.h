#pragma once
// Brushes on a region of the volume: select voxels by density. The result is one bit per voxel of the region, the same
// for preview, painting and tests. engine/annotation/painting.h, which works on the mask, decides which of the selected
// voxels may change group. The number of passes does not depend on the region's contents.

#include <span>

#include "engine/passes/volume_binding.h"
#include "shaders/regions/regions.h"

namespace shvr {

struct RegionInput {
    gpu::RegionParams params;            ///< complete except for the bricks
    const RegionBricks& bricks;          ///< the bricks that the region overlaps
    std::span<const gpu::RowSpan> rows;  ///< params.size.y * params.size.z spans, y fastest
};

/// Selects every voxel at or above the threshold.
Resource select_fill(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);
/// Selects the voxels connected to the seed through voxels at or above the threshold.
Resource select_flood(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);
/// Selects the connected components that have no voxel on the region's boundary.
Resource select_speckles(FrameGraph& graph, const VolumeBinding& volume, const RegionInput& input);

/// The flood and speckles brushes, given the bits of the region's voxels (engine/bricks/threshold_bricks.h). Bits
/// outside the region's rows must be 0.
Resource select_flood_in(FrameGraph& graph, const gpu::RegionParams& params, std::span<const uint32_t> bits);
Resource select_speckles_in(FrameGraph& graph, const gpu::RegionParams& params, std::span<const gpu::RowSpan> rows,
                            std::span<const uint32_t> bits);

/// Hints that a brush is likely to be used soon.
void expect_brushes(FrameGraph& graph, const VolumeBinding& volume);

/// Bits of a box of voxels, in a region's layout; the box may extend beyond the region.
struct SeedBits {
    Resource words;
    glm::uvec3 size{0};  ///< voxels
    uint32_t words_per_row = 0;
    glm::ivec3 from_region{0};  ///< the region's lower corner minus this box's
};
/// Selects the components of `mask` that contain a seed. `mask` has the bits of a region of any level; `params` has its
/// size, words and connectivity.
Resource select_object(FrameGraph& graph, const gpu::RegionParams& params, Resource mask, const SeedBits& seeds);

}  // namespace shvr
