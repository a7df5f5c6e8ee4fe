// Parameters of the kernel that computes the values of ambient occlusion (occlusion.h).
#ifndef SHVR_OCCLUSION_BAKE_H
#define SHVR_OCCLUSION_BAKE_H
#include "occlusion.h"

SHARED_BEGIN

/// Number of samples per ray: in voxels, and in cells of each size.
SHARED_CONST uint OCCLUSION_NEAR_TAPS = 3u;
SHARED_CONST uint OCCLUSION_TAPS_2 = 3u;
SHARED_CONST uint OCCLUSION_TAPS_4 = 2u;
/// Samples on each side of a voxel, evenly spaced, to find where the medium ends; lengths are in voxels. Two of them
/// are nearly always in the same voxel, so they share the voxel's fixed opacity.
SHARED_CONST uint OCCLUSION_EDGE_TAPS = 6u;
SHARED_CONST float OCCLUSION_EDGE_REACH = 1.5f;
/// Distance from the edge at which the device's rays begin. At this distance, their few samples differ least from the
/// definition, whose rays begin 0.07 voxels in front of the edge.
SHARED_CONST float OCCLUSION_LIFT = 0.13f;
/// Maximum distance between the edge and the voxel; it bounds the reach of rays.
SHARED_CONST float OCCLUSION_FURTHEST = 1.2f;
/// A sample along a ray: one cell's opacity, applied to `stretch` units of the ray.
struct OcclusionTap {
    float distance;
    float stretch;
};

struct OcclusionBakeParams {
    vec3 inverse_spacing;  ///< voxels per unit
    float radius;
    float first;          ///< initial length, in units, that never blocks light
    float gradient_fade;  ///< codes per voxel
    uint full_sphere;
    uint rays;
    float turn_cos;  ///< cosine of the angle, around the normal, between successive rays
    float turn_sin;
    uint reach;
    /// 1: computes all voxels in and next to occupied cells (painted voxels and ends of steps may be visible outside
    /// the cells' ranges); 0: only voxels next to which the transfer function shows something.
    uint grow;
    float table_lower;  ///< for `visible_intervals`, as in RaycastParams
    float table_upper;
    float table_scale;
    uint table_entries;
    float guard;  ///< leap.h
    uint aprons[OCCLUSION_SIZES];
    uvec3 cell_counts;  ///< size of the leap grid
    /// Samples from near to far; unused samples have a stretch of 0.
    OcclusionTap near_taps[OCCLUSION_NEAR_TAPS];
    OcclusionTap taps_2[OCCLUSION_TAPS_2];
    OcclusionTap taps_4[OCCLUSION_TAPS_4];
    float far_exponent;           ///< converts the first near tap's stretch to that of a tap in cells of 4
    OcclusionCellsParams voxels;  ///< as for gathering
};

SHARED_END
#endif
