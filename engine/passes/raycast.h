#pragma once
// Emission-absorption ray-casting of a bricked volume (shaders/rays: raycast.comp, integral.comp), slices through the
// volume (slice.comp), and picking of the point under the cursor (pick.comp).

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
    std::vector<gpu::OcclusionSegment> segments{};  ///< curve from arriving to visible light; if empty, a power law
};

/// Returns log2 of the shininess if it is a power of two, for which kernels can square; else NOT_A_POWER_OF_TWO.
uint32_t shininess_squarings(float shininess);

/// Rays that wait at bricks missing on the device and resume in a later graph (shaders/raycast.h, KEPT_ALL).
struct RaysInWaiting {
    Resource state;           ///< rgba32f image, as wide as the drawn pixels and twice as high; updated by raycast()
    bool have_begun = false;  ///< whether `state` has the result of an earlier graph
};

struct RaycastInput {
    const char* name = "raycast";  ///< name of its passes
    gpu::RaycastParams params;
    Resource table;  ///< rgba32f image in the layout of shaders/raycast.h
    std::optional<MaskBinding> mask;
    Resource groups;  ///< 256 x 2 rgba32f, with a mask: row 0 linear RGB, full step's opacity; row 1 its optical depth
    std::optional<RaycastOcclusion> occlusion;
    std::optional<Resource> surfaces;  ///< surfaces for the same pixels (engine/passes/surfaces.h)
    bool shaded = true;
    bool analytic_gradient = false;  ///< shades samples by the derivative of the interpolation (Gradient::analytic)
    bool count_work = false;
    PixelGroups pixel_groups;
    uint32_t shell = gpu::SHELL_NONE;  ///< unless SHELL_NONE, params.shell_* are set
    bool preintegrated = false;        ///< `table` is for steps between two densities
    bool integrated = false;           ///< `table` has the function's points; integrates without steps
    bool slice = false;                ///< draws a slice: voxels half-way along the rays, by params.slice_*
    bool smooth_borders = false;       ///< smooth borders of painted groups; requires Visibility::params.paint_reach 1
    bool pick = false;                 ///< computes positions instead of colours (pick.comp)
    RaysInWaiting* waiting = nullptr;  ///< for paged bricks only; null: rays do not wait
};

/// Pixels relative to a part's first pixel.
struct ShellPixels {
    glm::uvec2 begin{0}, end{0};
};
/// Returns a box of pixels that contains all rays that meet the region of params.shell_*. Returns the whole part if the
/// region begins before the rays do, because then the box cannot be determined.
ShellPixels shell_pixels(const gpu::RaycastParams& params);

/// Draws pixels params.pixel_begin ... pixel_end into `target`, an rgba32_float picture: linear light,
/// premultiplied, over the background. Returns the new version of `target`, and updates `volume.pages->reached`.
/// Long rays take one pass per block of steps; COUNTER_CUT_SHORT counts rays that exceed the maximum number of
/// blocks or that the device stops. If rays wait, they mark only the bricks that they wait for, and the picture is
/// final once no ray waits.
Resource raycast(FrameGraph& graph, VolumeBinding& volume, const RaycastInput& input, Resource target);

}  // namespace shvr
