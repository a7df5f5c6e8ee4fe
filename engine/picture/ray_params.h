#pragma once
// Computes the parameters of the kernels that trace rays from a look, a camera and a probe, in double. Pure functions.

#include "engine/device/scene.h"
#include "engine/passes/preview.h"
#include "engine/passes/raycast.h"
#include "engine/passes/surfaces.h"
#include "engine/picture/frame.h"

namespace shvr {

/// `step_voxels`: sample distance in reference lengths.
gpu::RaycastParams raycast_params(const Look& look, const Camera& camera, Scene& scene, const VolumeBinding& binding,
                                  const PicturePart& part, double step_voxels);
/// Sets the parameters that depend on the camera: rays, their entry points into the volume, light and depth.
void set_rays(gpu::RaycastParams& params, const Look& look, const Camera& camera, const VolumeInfo& info,
              const glm::uvec2& pixels);
/// Sets the parameters of a slice, which shows all voxels in grey, ignoring the cutting planes.
void set_slice(gpu::RaycastParams& params, const Look& look, Scene& scene);
void set_shell(RaycastInput& input, const ProbeLook& probe, Scene& scene);
void set_ball(gpu::SurfaceParams& params, const ProbeLook& probe, const VolumeInfo& info);
gpu::PreviewParams preview_params(const ProbeLook& probe, const RayPlanes& planes);

void set_planes(gpu::RaycastParams& params, const RayPlanes& planes);

}  // namespace shvr
