#pragma once
// Local ambient occlusion (shaders/occlusion/occlusion.h): computes the opacity of bricks, and the light that reaches
// their voxels.

#include <span>
#include <vector>

#include "engine/passes/volume_binding.h"
#include "shaders/occlusion/occlusion_bake.h"

namespace shvr {

struct OcclusionBinding {
    Resource values;  ///< r8ui, in slots with BRICK_TEXELS a side, as many slots as in the density atlas
    /// r32ui; a brick takes half of BRICK_SIZE a side in the first image, a quarter in the second. Paged bricks lie in
    /// slots; bricks of a resident volume lie side by side as in the volume.
    std::array<Resource, gpu::OCCLUSION_SIZES> cells{};
};

/// Temporary data gathered for a slice of bricks: images for up to OCCLUSION_SLICE jobs.
struct OcclusionScratch {
    Resource near;                                        ///< r32ui, opacity ramps
    std::array<Resource, gpu::OCCLUSION_SIZES> around{};  ///< r32ui, cells with aprons; for paged bricks
};
ResourceDesc occlusion_near_desc(uint32_t jobs, bool is_paged);
ResourceDesc occlusion_around_desc(uint32_t size, uint32_t jobs);

/// The places along a ray where opacity is sampled, and the weight of each sample. Lengths are in units of the brick's
/// level.
struct OcclusionTaps {
    double radius = 0.0;
    double first = 0.0;                   ///< length at the start of a ray that never blocks light
    std::vector<gpu::OcclusionTap> taps;  ///< from near to far; their stretches and `first` add up to the radius
    std::array<uint32_t, gpu::OCCLUSION_SIZES + 1> end{};          ///< end of the near taps, then of each cell size's
    double near_stretch = 0.0;                                     ///< ray length covered by the first near tap
    std::array<double, gpu::OCCLUSION_SIZES> stretches{1.0, 1.0};  ///< ray length covered by one tap, per cell size
    std::array<uint32_t, gpu::OCCLUSION_SIZES> aprons{};           ///< cells around a brick, as far as taps may reach
};
/// The largest radius, in voxels of any level.
inline constexpr double OCCLUSION_MAX_RADIUS = gpu::OCCLUSION_REACH * gpu::BRICK_SIZE - 4.0;
/// Radii below 1 have no taps: light reaches every voxel. `is_paged`: rays may also begin in a brick's apron.
OcclusionTaps occlusion_taps(double radius, bool is_paged = false);

/// Distance in bricks, on each side of a brick, from which light may arrive at the brick.
uint32_t occlusion_reach(double radius);

/// Sets `slots` to fully lit.
void occlusion_reset(FrameGraph& graph, OcclusionBinding& occlusion, std::span<const uint32_t> slots);
/// Initializes new images to fully lit and transparent; slot 0, the substitute for missing bricks, keeps these values.
void occlusion_begin(FrameGraph& graph, OcclusionBinding& occlusion);

struct OcclusionCellsInput {
    gpu::OcclusionCellsParams params;            ///< complete except for the mask
    std::vector<gpu::OcclusionEntry> opacities;  ///< one per table entry
    std::optional<MaskBinding> mask;
    std::vector<float> group_opacities;  ///< 256; used with a mask
};
/// All jobs must be in one level. Updates the handles of `occlusion` that it writes.
void occlusion_cells(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                     const OcclusionCellsInput& input, std::span<const gpu::OcclusionCellsJob> jobs);

struct OcclusionInput {
    gpu::OcclusionBakeParams params;  ///< complete except for the data derived from the other inputs
    OcclusionTaps taps;
    std::vector<uint32_t> visible_intervals;                                      ///< engine/look/transfer_function.h
    std::array<float, gpu::OCCLUSION_SIZES * gpu::OCCLUSION_LEVELS> exponents{};  ///< as in OcclusionGatherParams
    OcclusionCellsInput near;  ///< opacities for the length covered by the first near tap
};
/// All jobs, at most OCCLUSION_SLICE of them, must be in one level. `around`: for each job, the bricks around the job's
/// brick, see OcclusionJob.
void occlusion_bake(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                    OcclusionScratch& scratch, const OcclusionInput& input, std::span<const gpu::OcclusionJob> jobs,
                    std::span<const uint32_t> around);

}  // namespace shvr
