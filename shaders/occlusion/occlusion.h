// Local ambient occlusion: how much light reaches a voxel from the space around it, up to a radius (Hernell, Ljung and
// Ynnerman 2007). Lengths are in units of the brick's level: 2^level reference lengths.
//
// Definition: the light of a ray is the share of the radius along which light arrives, (1 / radius) integral of the
// light left; a voxel's light is the mean over directions. Let o(s) be the opacity of one unit, s in voxels along the
// direction in which densities fall fastest per voxel, and o' the maximum of o over -1.5 < s < 0.25:
//
//   surface   strength = g^2 / (g^2 + fade^2) for a gradient of g per voxel
//   edge      the voxel is moved in that direction to where the medium ends: by the integral over 0 < s < 1.5 of the
//             running minimum of e(s), minus the integral over -1.5 < s < 0 of 1 - the running maximum, where
//             e = 1 - (1 - min(o / o', 1))^2. Rays begin 0.07 voxels in front. Strength scales all of this. (The few
//             samples of the device err least from OCCLUSION_LIFT on; occlusion_bake.h.)
//   side      directions whose cosine with the normal is below strength - 1 are replaced by their mirror image in
//             front of the surface, unless the full sphere is requested.
//   itself    within its own voxel, a ray meets no more opacity than half a unit after leaving it.
//
// So a ray begins at the visible edge, at any depth of its voxel. The edge is sought in voxels, since samples
// interpolate between voxels; rays and the normal are in physical space. In double: tests/reference/occlusion.h.
//
// A "ramp" encodes in 32 bits how opacity varies inside a cube: a plane is fitted to the cube's densities and mapped
// through the transfer function to an opacity that rises linearly from 0 to a maximum (top). Position and width of the
// rise follow from the function's mean and mean square over the densities of the cube, found by sums over the table.
// Ramps resolve a surface inside a cube, so no correction for the half-space behind the surface is needed.
//
// "Cells" hold the opacity of the medium, in two coarse copies of every brick. Cells of 2^3 voxels are ramps. Cells of
// 4^3 have three codes, the opacities of paths through the cell along x, y and z, each the mean over the cell's
// columns: even a thin wall blocks rays that cross it, but not rays parallel to it. Opacity = (code / 255)^2; the
// square root puts more codes where opacities are small. A ray takes the mean of the three, weighted with the squares
// of its direction. Both kinds apply to the stretch of a ray that one cell represents; stretches grow with the radius.
//
// "Near" values are ramps of voxels. They are computed from densities and gradients for each brick in turn, with the
// surroundings of the brick, and then discarded. So are the copies of cells around a paged brick, which let rays read
// contiguous memory. Cells of a resident volume are contiguous, so none are copied. A voxel whose opacity is fixed by
// paint or a cut has this opacity throughout.
//
// "Values" are the result, 255 where all light arrives, in slots like those of the density atlas, aprons included. In a
// resident volume a brick's values are also written to the aprons of its neighbours. A paged brick's aprons are
// computed with the brick, from the same numbers and to the same bits. Its values thus depend only on the bricks around
// it, and not on whether and when values of those bricks were computed.
#ifndef SHVR_OCCLUSION_H
#define SHVR_OCCLUSION_H
#include "../bricks.h"

SHARED_BEGIN

SHARED_CONST uint OCCLUSION_SIZES = 2u;  // number of cell sizes; cells have 2 << size voxels a side
/// Maximum number of bricks whose values are computed at once: enough to keep a GPU busy.
SHARED_CONST uint OCCLUSION_SLICE = 256u;
/// The scratch images hold the bricks of a slice in columns along z. The columns are arranged in rows along x.
SHARED_CONST uint OCCLUSION_COLUMN = 16u;
SHARED_CONST uint OCCLUSION_COLUMNS_A_ROW = 4u;
SHARED_CONST uint OCCLUSION_NEAR_APRON = 4u;  // voxels
SHARED_CONST uint OCCLUSION_NEAR_SIDE = 40u;  // BRICK_SIZE + 2 OCCLUSION_NEAR_APRON
/// Like OCCLUSION_NEAR_APRON, for paged bricks, whose rays may also begin in the apron.
SHARED_CONST uint OCCLUSION_NEAR_APRON_PAGED = 8u;
SHARED_CONST uint OCCLUSION_NEAR_SIDE_PAGED = 48u;
/// Maximum distance, in bricks on each side of a brick, from which light can arrive. It limits the radius.
SHARED_CONST uint OCCLUSION_REACH = 2u;
SHARED_CONST uint OCCLUSION_AROUND = 125u;  // (2 OCCLUSION_REACH + 1)^3
/// Workgroups per brick; with several, even few bricks keep a GPU busy.
SHARED_CONST uint OCCLUSION_SPLIT = 8u;
/// An entry of `around` contains a packed slot and, from this bit on, the number of levels by which its brick is
/// coarser than the job's brick. An entry of 0: no brick.
SHARED_CONST uint OCCLUSION_LEVEL_SHIFT = 24u;

/// Maximum number of levels of a volume.
SHARED_CONST uint OCCLUSION_LEVELS = 32u;

/// A brick whose cells one workgroup computes.
struct OcclusionCellsJob {
    uvec3 brick;  ///< in bricks of its level
    uint slot;
};

/// An entry of the transfer function: an opacity, and the sums of opacities and of their squares over the preceding
/// entries. Each sum is two floats, a value and its remainder: if many lower densities are opaque, sums over a few
/// translucent entries are small differences of large numbers.
struct OcclusionEntry {
    float opacity;
    vec2 sums;
    vec2 rests;
};

struct OcclusionCellsParams {
    float table_lower;  ///< as in RaycastParams
    float table_upper;
    float table_scale;
    uint table_entries;
    uint level;
    vec3 lower;  ///< lower corner, in level 0 voxels, of the box outside of which all is empty
    vec3 upper;
    vec4 cut_plane;      ///< all is empty where dot(xyz, voxel) + w > 0
    uvec3 brick_counts;  ///< of level 0
    float far_exponent;  ///< exponent, for cells of 4^3 voxels, of transmittances from the table
};

/// A brick whose values OCCLUSION_SPLIT workgroups compute.
struct OcclusionJob {
    uvec3 brick;
    uint slot;
    uint around;  ///< index of the job's first brick in the list of surrounding bricks, x fastest
};

/// Parameters for gathering what surrounds the bricks of one level.
struct OcclusionGatherParams {
    OcclusionCellsParams voxels;
    uvec3 cell_counts;  ///< size of the leap grid
    uint reach;
    uint aprons[OCCLUSION_SIZES];  ///< in cells of each size
    /// Exponents that convert opacities of coarser levels' cells to the stretches of this level's taps.
    float exponents[OCCLUSION_SIZES * OCCLUSION_LEVELS];
};

/// The bits of a ramp: 8 for the top, coded as in cells; 6 for the height at the centre, measured from half of the top,
/// in units of top / RAMP_HEIGHTS; 6 per axis for the slope across the cube, in units of top / RAMP_SLOPES. A height of
/// RAMP_HELD: the opacity is fixed by paint or a cut.
SHARED_CONST float RAMP_HEIGHTS = 20.0f, RAMP_SLOPES = 10.0f;
SHARED_CONST int RAMP_HELD = 31;

SHARED_FUNCTION uint ramp_bits(uint top, int height, ivec3 slope)
{
    return top | (uint(height) & 63u) << 8u | (uint(slope.x) & 63u) << 14u | (uint(slope.y) & 63u) << 20u |
           uint(slope.z) << 26u;
}

SHARED_FUNCTION int ramp_height(uint packed)
{
    return int(packed << 18u) >> 26;
}

SHARED_FUNCTION ivec3 ramp_slope(uint packed)
{
    return ivec3(int(packed << 12u) >> 26, int(packed << 6u) >> 26, int(packed) >> 26);
}

/// The position of a job's brick in the scratch images, in bricks.
SHARED_FUNCTION uvec3 scratch_place(uint job)
{
    const uint column = job / OCCLUSION_COLUMN;
    return uvec3(column % OCCLUSION_COLUMNS_A_ROW, column / OCCLUSION_COLUMNS_A_ROW, job % OCCLUSION_COLUMN);
}

/// Converts values to the share of ambient light: 1 - strength (1 - value^curve), which maps 1 to 1. With a curve of
/// points (OCCLUSION_MAPPED of raycast.comp): 1 - strength (1 - lowest - the sum of the rises of its segments).
struct OcclusionLook {
    float strength;
    float curve;
    float lowest;   ///< value of the curve of points at its first point
    uint segments;  ///< number of OcclusionSegment that follow this struct
};

/// rise clamp((value - begin) per_width, 0, 1)
struct OcclusionSegment {
    float begin;
    float per_width;
    float rise;
};

SHARED_END
#endif
