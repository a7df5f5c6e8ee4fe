#pragma once
// Ambient occlusion samples for voxels that are not cubes (STRETCHED in shaders/occlusion/occlusion_bake.comp).

#include "engine/passes/occlusion.h"

namespace shvr {

/// Up to this radius, in voxels of any level, all samples in cells use cells of two voxels.
inline constexpr double OCCLUSION_MAX_RADIUS_OF_2 = 26.0;

/// Like occlusion_taps(), for voxels with edge lengths `spacing`.
OcclusionTaps occlusion_taps_of(const glm::dvec3& spacing, double radius, bool is_paged = false);

}  // namespace shvr
