#pragma once
// Local ambient occlusion (shaders/occlusion/occlusion.h): computes the opacity of bricks, and the light that reaches
// their voxels.

#include <span>
#include <vector>

#include "engine/passes/volume_binding.h"
#include "shaders/occlusion/occlusion_bake.h"

namespace shvr {

struct OcclusionBinding {
    Resource values;  ///< r8ui, with as many slots as the density atlas, each with BRICK_TEXELS a side
    /// r32ui; a brick takes half of BRICK_SIZE a side in the first image and a quarter in the second. Paged bricks are
    /// in slots; bricks of a resident volume are contiguous, in the volume's order.
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
    double first = 0.0;                   ///< length at a ray's start in which nothing blocks light
    std::vector<gpu::OcclusionTap> taps;  ///< from near to far; the sum of their stretches and `first` is the radius
    std::array<uint32_t, gpu::OCCLUSION_SIZES + 1> end{};          ///< ends in `taps`: near taps, then each cell size
    double near_stretch = 0.0;                                     ///< ray length covered by the first near tap
    std::array<double, gpu::OCCLUSION_SIZES> stretches{1.0, 1.0};  ///< ray length covered by one tap, per cell size
    std::array<uint32_t, gpu::OCCLUSION_SIZES> aprons{};           ///< how many cells beyond a brick its taps reach
};
/// The largest radius, in voxels of any level.
inline constexpr double OCCLUSION_MAX_RADIUS = gpu::OCCLUSION_REACH * gpu::BRICK_SIZE - 4.0;
/// Radii below 1 have no taps, so all voxels are lit. `is_paged`: rays may also begin in a brick's apron.
OcclusionTaps occlusion_taps(double radius, bool is_paged = false);

/// Maximum distance, in bricks, from which light can reach a brick.
uint32_t occlusion_reach(double radius);

/// Sets `slots` to fully lit.
void occlusion_reset(FrameGraph& graph, OcclusionBinding& occlusion, std::span<const uint32_t> slots);
/// Initializes new images as fully lit and transparent. Slot 0, which stands for missing bricks, keeps these values.
void occlusion_begin(FrameGraph& graph, OcclusionBinding& occlusion);

struct OcclusionCellsInput {
    gpu::OcclusionCellsParams params;            ///< complete except for the mask
    std::vector<gpu::OcclusionEntry> opacities;  ///< one per table entry
    std::optional<MaskBinding> mask;
    std::vector<float> group_opacities;  ///< 256; used with a mask
};
/// All jobs must be in one level. Updates those handles of `occlusion` that the pass writes.
void occlusion_cells(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                     const OcclusionCellsInput& input, std::span<const gpu::OcclusionCellsJob> jobs);

struct OcclusionInput {
    gpu::OcclusionBakeParams params;  ///< members derived from the other inputs may be left unset
    OcclusionTaps taps;
    std::vector<uint32_t> visible_intervals;                                      ///< engine/look/transfer_function.h
    std::array<float, gpu::OCCLUSION_SIZES * gpu::OCCLUSION_LEVELS> exponents{};  ///< as in OcclusionGatherParams
    OcclusionCellsInput near;  ///< opacities for the ray length covered by the first near tap
};
/// There may be up to OCCLUSION_SLICE jobs, all in one level. `around`: for each job, the bricks around the job's brick
/// (see OcclusionJob).
void occlusion_bake(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                    OcclusionScratch& scratch, const OcclusionInput& input, std::span<const gpu::OcclusionJob> jobs,
                    std::span<const uint32_t> around);

}  // namespace shvr
