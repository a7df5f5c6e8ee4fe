#pragma once
// Emission-absorption ray-casting of a bricked volume (shaders/raycast.comp).

#include <optional>
#include <span>
#include <vector>

#include "engine/passes/adaptive.h"
#include "engine/passes/pixel_groups.h"
#include "engine/passes/volume_binding.h"
#include "shaders/counters.h"
#include "shaders/occlusion/occlusion.h"
#include "shaders/raycast.h"

namespace shvr {

/// Ambient light that is blocked.
struct RaycastOcclusion {
    Resource values;  ///< OcclusionBinding::values
    gpu::OcclusionLook look;
    std::vector<gpu::OcclusionSegment> segments{};  ///< empty: the light follows a power
};

/// log2 of the shininess if the kernels can reach it by squaring, otherwise gpu::NOT_A_POWER_OF_TWO.
uint32_t shininess_squarings(float shininess);

/// Rays that wait where a brick is not on the device, and go on in a later graph (shaders/raycast.h, KEPT_ALL).
struct RaysInWaiting {
    Resource state;           ///< rgba32f picture of the drawn pixels, twice as high; updated by raycast()
    bool have_begun = false;  ///< `state` holds what an earlier graph left
};

struct RaycastInput {
    const char* name = "raycast";  ///< of its passes
    gpu::RaycastParams params;
    Resource table;  ///< rgba32f image, as shaders/raycast.h has it
    std::optional<MaskBinding> mask;
    Resource groups;  ///< with a mask: rgba32f image of 256 x 2: linear RGB, opacity of a full step; its optical depth
    std::optional<RaycastOcclusion> occlusion;
    std::optional<Resource> surfaces;  ///< of the same pixels (engine/passes/surfaces.h)
    bool shaded = true;
    bool count_work = false;
    PixelGroups pixel_groups;
    uint32_t shell = gpu::SHELL_NONE;  ///< otherwise params.shell_* are set
    bool preintegrated = false;        ///< `table` is for steps between two densities
    bool slice = false;                ///< params.slice_* are set: draws what lies half-way along the rays
    bool smooth_borders = false;       ///< of groups; with Visibility::params.paint_reach 1
    bool pick = false;                 ///< positions instead of colours, see the kernel
    std::optional<ListedBlocks>
        blocks;                        ///< whose pixels alone are drawn, into a target that has the others; none waits
    RaysInWaiting* waiting = nullptr;  ///< of paged bricks; null: rays wait for nothing
};

/// Pixels of a part, from its first one on.
struct ShellPixels {
    glm::uvec2 begin{0}, end{0};
};
/// No ray outside of them meets the region of params.shell_*. All pixels of the part where that cannot be told: where
/// the region begins before the rays do.
ShellPixels shell_pixels(const gpu::RaycastParams& params);

/// Draws pixels params.pixel_begin ... pixel_end into `target`, an rgba32_float picture: linear light, premultiplied,
/// over the background. Returns its new version, and updates `volume.pages->reached`. Long rays take a pass for each
/// block of their steps; of a ray that is longer than the largest number of blocks reaches, and of one that the device
/// stops, COUNTER_CUT_SHORT tells. Rays in waiting mark only the bricks that they wait for; the picture is what it
/// should be once none does.
Resource raycast(FrameGraph& graph, VolumeBinding& volume, const RaycastInput& input, Resource target);

}  // namespace shvr
