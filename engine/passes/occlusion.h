#pragma once
// Local ambient occlusion (shaders/occlusion.h): what stops light in bricks, and the light that reaches their voxels.

#include <span>
#include <vector>

#include "engine/passes/volume_binding.h"
#include "shaders/occlusion_bake.h"

namespace shvr {

/// Images of slots, as many as the density atlas has.
struct OcclusionBinding {
    Resource values;                                     ///< r8ui, BRICK_TEXELS a side
    std::array<Resource, gpu::OCCLUSION_SIZES> cells{};  ///< r8ui; half of BRICK_SIZE a side, a quarter
};

/// What is gathered for a slice of bricks, and forgotten: images of OCCLUSION_SLICE jobs.
struct OcclusionScratch {
    Resource near;                                        ///< r32ui, see near_opacity
    std::array<Resource, gpu::OCCLUSION_SIZES> around{};  ///< r8ui, cells with aprons
};
ResourceDesc occlusion_near_desc();
ResourceDesc occlusion_around_desc(uint32_t size);

/// Where rays look, and what they find there does. Lengths in units of the brick's level.
struct OcclusionTaps {
    double radius = 0.0;
    double first = 0.0;                   ///< what light always passes
    std::vector<gpu::OcclusionTap> taps;  ///< the nearest first; their stretches and `first` make the radius
    std::array<uint32_t, gpu::OCCLUSION_SIZES + 1> end{};  ///< taps that are near, and of each size of cells, end here
    double near_stretch = 0.0;                             ///< of each near tap
    double exponent = 1.0;                                 ///< from the way through a cell to the stretch of its taps
    std::array<uint32_t, gpu::OCCLUSION_SIZES> aprons{};   ///< cells around a brick that taps may meet
};
/// The largest radius, in units of any level.
inline constexpr double OCCLUSION_MOST_RADIUS = gpu::OCCLUSION_REACH * gpu::BRICK_SIZE - 4.0;
/// Radii below 1 have no tap: light reaches every voxel.
OcclusionTaps occlusion_taps(double radius);

/// Bricks on each side of a brick that its light comes from.
uint32_t occlusion_reach(double radius);

/// Lets all light arrive in `slots`. `with_empty`: and makes slot 0, of bricks that are not there, let all light
/// through.
void occlusion_reset(FrameGraph& graph, OcclusionBinding& occlusion, std::span<const uint32_t> slots, bool with_empty);

struct OcclusionCellsInput {
    gpu::OcclusionCellsParams params;  ///< but for the mask
    std::vector<float> opacities;      ///< of one unit, entry by entry of the table
    std::optional<MaskBinding> mask;
    std::vector<float> group_opacities;  ///< 256, of one unit; used with a mask
};
/// All of one level. Renews the handles of `occlusion` that it writes.
void occlusion_cells(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                     const OcclusionCellsInput& input, std::span<const gpu::OcclusionCellsJob> jobs);

struct OcclusionInput {
    gpu::OcclusionBakeParams params;  ///< but for what follows from the others
    OcclusionTaps taps;
    OcclusionCellsInput near;  ///< opacities of the near taps' stretch
};
/// All of one level, at most OCCLUSION_SLICE. `around`: for each job the bricks around it, see OcclusionJob.
void occlusion_bake(FrameGraph& graph, const VolumeBinding& volume, OcclusionBinding& occlusion,
                    OcclusionScratch& scratch, const OcclusionInput& input, std::span<const gpu::OcclusionJob> jobs,
                    std::span<const uint32_t> around);

}  // namespace shvr
