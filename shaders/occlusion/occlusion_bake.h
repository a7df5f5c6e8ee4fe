// Parameters of the kernel that computes ambient occlusion's values (occlusion.h).
#ifndef SHVR_OCCLUSION_BAKE_H
#define SHVR_OCCLUSION_BAKE_H
#include "occlusion.h"

SHARED_BEGIN

/// Number of taps each in half voxels, in cells of two voxels and in cells of four.
SHARED_CONST uint OCCLUSION_TAPS_EACH = 2u;

struct OcclusionBakeParams {
    vec3 inverse_spacing;  ///< voxels per unit
    float radius;
    float first;          ///< length that light always passes, in units: no voxel shadows itself
    float gradient_fade;  ///< codes per unit; gradients of 0, or any if `full_sphere`, have no hemisphere
    uint full_sphere;
    uint rays;
    float turn_cos;  ///< angle between successive rays, about z
    float turn_sin;
    uint reach;
    uint grow;  ///< 1: also voxels beside those of occupied cells (painted ones show outside the cells' ranges)
    uint aprons[OCCLUSION_SIZES];
    uvec3 cell_counts;                      ///< of the leap grid
    OcclusionTap taps[OCCLUSION_MAX_TAPS];  ///< the nearest first; unused ones have a stretch of 0
};

SHARED_END
#endif
