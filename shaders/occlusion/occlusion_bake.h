// Parameters of the kernel that computes ambient occlusion's values (occlusion.h).
#ifndef SHVR_OCCLUSION_BAKE_H
#define SHVR_OCCLUSION_BAKE_H
#include "occlusion.h"

SHARED_BEGIN

/// Samples per ray: in voxels, and in cells of each size.
SHARED_CONST uint OCCLUSION_NEAR_TAPS = 3u;
SHARED_CONST uint OCCLUSION_TAPS_2 = 3u;
SHARED_CONST uint OCCLUSION_TAPS_4 = 2u;
/// Samples on each side of a voxel, evenly spaced, to find where the medium ends; lengths are in voxels. Nearly always
/// two of them are in one voxel, so they share its fixed opacity.
SHARED_CONST uint OCCLUSION_EDGE_TAPS = 6u;
SHARED_CONST float OCCLUSION_EDGE_REACH = 1.5f;
/// Distance in front of the edge at which rays of so few samples begin: with it they err least from the definition,
/// whose rays begin 0.07 voxels in front of the edge.
SHARED_CONST float OCCLUSION_LIFT = 0.13f;
/// Maximum distance of the edge from the voxel, so that the reach of rays is bounded.
SHARED_CONST float OCCLUSION_FURTHEST = 1.2f;
/// A sample along a ray: one cell's opacity, applied to `stretch` units of the ray.
struct OcclusionTap {
    float distance;
    float stretch;
};

struct OcclusionBakeParams {
    vec3 inverse_spacing;  ///< voxels per unit
    float radius;
    float first;          ///< initial length that never blocks light, in units
    float gradient_fade;  ///< codes per voxel
    uint full_sphere;
    uint rays;
    float turn_cos;  ///< cosine of the angle between successive rays, about the normal
    float turn_sin;
    uint reach;
    /// 1: computes all voxels of occupied cells and of those next to them (painted voxels and ends of steps may be
    /// visible outside the cells' ranges); 0: only voxels next to which the transfer function shows something.
    uint grow;
    float table_lower;  ///< for `visible_intervals`, as in RaycastParams
    float table_upper;
    float table_scale;
    uint table_entries;
    float guard;  ///< leap.h
    uint aprons[OCCLUSION_SIZES];
    uvec3 cell_counts;  ///< size of the leap grid
    /// Samples from near to far; unused ones have a stretch of 0.
    OcclusionTap near_taps[OCCLUSION_NEAR_TAPS];
    OcclusionTap taps_2[OCCLUSION_TAPS_2];
    OcclusionTap taps_4[OCCLUSION_TAPS_4];
    float far_exponent;           ///< converts the stretch of the first near tap to that of a tap in cells of 4
    OcclusionCellsParams voxels;  ///< as for gathering
};

SHARED_END
#endif
