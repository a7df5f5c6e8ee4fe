#pragma once
// Local ambient occlusion (shaders/occlusion/occlusion.h): how opaque bricks are, and the light that reaches their
// voxels.

#include <span>
#include <vector>

#include "engine/passes/volume_binding.h"
#include "shaders/occlusion/occlusion_bake.h"

namespace shvr {

struct OcclusionBinding {
    Resource values;  ///< r8ui, in slots of BRICK_TEXELS a side, as many as the density atlas has
    /// r32ui; a brick is half of BRICK_SIZE a side, and a quarter. Paged ones are in slots, those of a resident volume
    /// side by side as in the volume.
    std::array<Resource, gpu::OCCLUSION_SIZES> cells{};
};

/// Temporary data gathered for a slice of bricks: images for as many jobs, at most OCCLUSION_SLICE.
struct OcclusionScratch {
    Resource near;                                        ///< r32ui, ramps
    std::array<Resource, gpu::OCCLUSION_SIZES> around{};  ///< r32ui, cells with aprons; of paged bricks
};
ResourceDesc occlusion_near_desc(uint32_t jobs, bool is_paged);
ResourceDesc occlusion_around_desc(uint32_t size, uint32_t jobs);

/// Where rays sample opacity, and the weight of each sample. Lengths in units of the brick's level.
struct OcclusionTaps {
    double radius = 0.0;
    double first = 0.0;                   ///< length that light always passes
    std::vector<gpu::OcclusionTap> taps;  ///< the nearest first; their stretches and `first` make the radius
    std::array<uint32_t, gpu::OCCLUSION_SIZES + 1> end{};          ///< end of the near taps, then of each cell size's
    double near_stretch = 0.0;                                     ///< of the first near tap
    std::array<double, gpu::OCCLUSION_SIZES> stretches{1.0, 1.0};  ///< of a tap in cells of each size
    std::array<uint32_t, gpu::OCCLUSION_SIZES> aprons{};           ///< cells around a brick that taps may reach
};
/// The largest radius, in units of any level.
inline constexpr double OCCLUSION_MAX_RADIUS = gpu::OCCLUSION_REACH * gpu::BRICK_SIZE - 4.0;
/// Radii below 1 have no tap: light reaches every voxel. `is_paged`: for rays that begin in a brick's apron as well.
OcclusionTaps occlusion_taps(double radius, bool is_paged = false);

/// How many bricks on each side of a brick its light comes from.
uint32_t occlusion_reach(double radius);

/// Sets `slots` to fully lit.
void occlusion_reset(FrameGraph& graph, OcclusionBinding& occlusion, std::span<const uint32_t> slots);
/// Sets new images to fully lit and transparent: slot 0, which stands for missing bricks, stays so.
void occlusion_begin(FrameGraph& graph, OcclusionBinding& occlusion);

struct OcclusionCellsInput {
    gpu::OcclusionCellsParams params;            ///< all but the mask
    std::vector<gpu::OcclusionEntry> opacities;  ///< for each entry of the table
    std::optional<MaskBinding> mask;
    std::vector<float> group_opacities;  ///< 256; used with a mask
};
/// Jobs of one level. Updates the handles of `occlusion` that it writes.
void occlusion_cells(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                     const OcclusionCellsInput& input, std::span<const gpu::OcclusionCellsJob> jobs);

struct OcclusionInput {
    gpu::OcclusionBakeParams params;  ///< all but what follows from the other inputs
    OcclusionTaps taps;
    std::vector<uint32_t> visible_intervals;                                      ///< engine/look/transfer_function.h
    std::array<float, gpu::OCCLUSION_SIZES * gpu::OCCLUSION_LEVELS> exponents{};  ///< as in OcclusionGatherParams
    OcclusionCellsInput near;  ///< opacities of the first near tap's stretch
};
/// Jobs of one level, at most OCCLUSION_SLICE. `around`: for each job the bricks around it, see OcclusionJob.
void occlusion_bake(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                    OcclusionScratch& scratch, const OcclusionInput& input, std::span<const gpu::OcclusionJob> jobs,
                    std::span<const uint32_t> around);

}  // namespace shvr
