#pragma once
// Emission-absorption ray-casting of a bricked volume (shaders/rays: raycast.comp, integral.comp), slices through it
// (slice.comp) and the place that a person points at (pick.comp).

#include <optional>
#include <span>
#include <vector>

#include "engine/passes/pixel_groups.h"
#include "engine/passes/volume_binding.h"
#include "shaders/counters.h"
#include "shaders/occlusion/occlusion.h"
#include "shaders/raycast.h"

namespace shvr {

/// Blocking of ambient light.
struct RaycastOcclusion {
    Resource values;  ///< OcclusionBinding::values
    gpu::OcclusionLook look;
    std::vector<gpu::OcclusionSegment> segments{};  ///< curve from arriving to visible light; empty: a power law
};

/// log2 of the shininess if the kernels can reach it by squaring, otherwise gpu::NOT_A_POWER_OF_TWO.
uint32_t shininess_squarings(float shininess);

/// Rays that stop and wait at bricks missing on the device, and resume in a later graph (shaders/raycast.h, KEPT_ALL).
struct RaysInWaiting {
    Resource state;           ///< rgba32f picture of the drawn pixels, twice as high; updated by raycast()
    bool have_begun = false;  ///< `state` contains the result of an earlier graph
};

struct RaycastInput {
    const char* name = "raycast";  ///< name of its passes
    gpu::RaycastParams params;
    Resource table;  ///< rgba32f image in the layout of shaders/raycast.h
    std::optional<MaskBinding> mask;
    Resource groups;  ///< with a mask: rgba32f image of 256 x 2: linear RGB, opacity of a full step; its optical depth
    std::optional<RaycastOcclusion> occlusion;
    std::optional<Resource> surfaces;  ///< for the same pixels (engine/passes/surfaces.h)
    bool shaded = true;
    bool count_work = false;
    PixelGroups pixel_groups;
    uint32_t shell = gpu::SHELL_NONE;  ///< otherwise params.shell_* are set
    bool preintegrated = false;        ///< `table` is for steps between two densities
    bool integrated = false;           ///< `table` has the function's points: the integral without steps
    bool slice = false;                ///< draws a slice: the voxels half-way along the rays, with params.slice_*
    bool smooth_borders = false;       ///< smooth borders of painted groups; with Visibility::params.paint_reach 1
    bool pick = false;                 ///< positions instead of colours, see the kernel
    RaysInWaiting* waiting = nullptr;  ///< paged bricks only; null: rays do not wait
};

/// Pixels relative to a part's first pixel.
struct ShellPixels {
    glm::uvec2 begin{0}, end{0};
};
/// Returns a box of pixels outside of which no ray meets the region of params.shell_*. The whole part if that cannot be
/// determined: if the region begins before the rays do.
ShellPixels shell_pixels(const gpu::RaycastParams& params);

/// Draws pixels params.pixel_begin ... pixel_end into `target`, an rgba32_float picture: linear
/// light, premultiplied, over the background. Returns its new version, and updates
/// `volume.pages->reached`. Long rays take one pass per block of their steps; COUNTER_CUT_SHORT
/// counts rays that exceed the maximum number of blocks or that the device stops. Waiting rays
/// mark only the bricks that they wait for; the picture is final once no ray waits.
Resource raycast(FrameGraph& graph, VolumeBinding& volume, const RaycastInput& input, Resource target);

}  // namespace shvr
