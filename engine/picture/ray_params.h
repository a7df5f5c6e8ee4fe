#pragma once
// What kernels that follow rays are told of a look, a camera and a probe. Computed in double; pure.

#include "engine/device/scene.h"
#include "engine/passes/preview.h"
#include "engine/passes/raycast.h"
#include "engine/passes/surfaces.h"
#include "engine/picture/frame.h"

namespace shvr {

/// `step_voxels`: between samples, in reference lengths.
gpu::RaycastParams raycast_params(const Look& look, const Camera& camera, Scene& scene, const VolumeBinding& binding,
                                  const PicturePart& part, double step_voxels);
/// What depends on the camera: rays, what they meet of the volume, light and depth.
void set_rays(gpu::RaycastParams& params, const Look& look, const Camera& camera, const VolumeInfo& info,
              const glm::uvec2& pixels);
/// A slice shows the whole volume, whatever is cut away, in grey.
void set_slice(gpu::RaycastParams& params, const Look& look, Scene& scene);
void set_shell(RaycastInput& input, const ProbeLook& probe, Scene& scene);
void set_ball(gpu::SurfaceParams& params, const ProbeLook& probe, const VolumeInfo& info);
gpu::PreviewParams preview_params(const ProbeLook& probe, const Camera& camera, const glm::uvec2& pixels,
                                  const VolumeInfo& info);

}  // namespace shvr
