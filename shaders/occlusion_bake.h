// Parameters of the kernel that makes ambient occlusion's values (occlusion.h).
#ifndef SHVR_OCCLUSION_BAKE_H
#define SHVR_OCCLUSION_BAKE_H
#include "occlusion.h"

SHARED_BEGIN

/// Looks at halves of voxels, at cells of two voxels and at those of four; each as many.
SHARED_CONST uint OCCLUSION_TAPS_EACH = 2u;

struct OcclusionBakeParams {
    vec3 inverse_spacing;  ///< voxels per unit
    float radius;
    float first;          ///< units that light always passes: no voxel shadows itself
    float gradient_fade;  ///< codes per unit; 0 gradients, and all where `full_sphere`, have no hemisphere
    uint full_sphere;
    uint rays;
    float turn_cos;  ///< from one ray to the next, about z
    float turn_sin;
    uint reach;
    uint grow;  ///< 1: voxels beside those of occupied cells, too (painted ones show outside the cells' ranges)
    uint aprons[OCCLUSION_SIZES];
    uvec3 cell_counts;                       ///< of the leap grid
    OcclusionTap taps[OCCLUSION_MOST_TAPS];  ///< the nearest first; a stretch of 0 where there are fewer
};

SHARED_END
#endif
