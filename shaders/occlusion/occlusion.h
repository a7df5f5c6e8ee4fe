// Local ambient occlusion: how much light reaches a voxel from the space around it, up to a radius (Hernell, Ljung and
// Ynnerman 2007). Lengths are in units of the brick's level: 2^level reference lengths.
//
// "Cells" hold the opacity of the medium, in two coarse copies of every brick: means over 2^3 and 4^3 voxels. A cell's
// code gives the opacity of a path through it, 2 or 4 units long: opacity = (code / 255)^2. The square root puts more
// codes where opacities are small. The mean is of path opacities, not of extinction: half of a cell behind a surface
// stops half of the light, however dense it is.
//
// "Near" is the opacity right around a voxel, in steps of half a voxel: at steep surfaces, whole voxels are too coarse
// for rays that pass close by. It is computed from densities and gradients for each brick in turn, with the
// surroundings of the brick, and then discarded; so are copies of the cells around the brick, which let rays read from
// one piece of memory.
//
// "Values" are the result, 255 where all light arrives, in slots like those of the density atlas, aprons included.
#ifndef SHVR_OCCLUSION_H
#define SHVR_OCCLUSION_H
#include "../bricks.h"

SHARED_BEGIN

SHARED_CONST uint OCCLUSION_SIZES = 2u;  // of cells: 2 << size voxels a side
SHARED_CONST uint OCCLUSION_MAX_TAPS = 6u;
/// Bricks whose values can be computed at once: the scratch images hold as many, stacked along z.
SHARED_CONST uint OCCLUSION_SLICE = 16u;
SHARED_CONST uint OCCLUSION_NEAR_APRON = 4u;  // voxels
SHARED_CONST uint OCCLUSION_NEAR_SIDE = 40u;  // BRICK_SIZE + 2 OCCLUSION_NEAR_APRON
/// Maximum number of bricks on each side of a brick that its light comes from; sets the largest radius.
SHARED_CONST uint OCCLUSION_REACH = 2u;
SHARED_CONST uint OCCLUSION_AROUND = 125u;  // (2 OCCLUSION_REACH + 1)^3
/// Workgroups per brick: more of them keep a GPU busy with few bricks.
SHARED_CONST uint OCCLUSION_SPLIT = 8u;
/// An entry of `around` is a packed slot and, from this bit on, how many levels its brick is above the job's; 0: none.
SHARED_CONST uint OCCLUSION_LEVEL_SHIFT = 24u;

/// A brick whose cells are computed: one workgroup.
struct OcclusionCellsJob {
    uvec3 brick;  ///< of its level
    uint slot;
};

struct OcclusionCellsParams {
    float table_lower;  ///< as in RaycastParams
    float table_upper;
    float table_scale;
    uint table_entries;
    uint level;
    vec3 lower;  ///< what blocks light, voxels of level 0; everything outside is empty
    vec3 upper;
    uvec3 brick_counts;  ///< of level 0
};

/// A brick whose values are computed: OCCLUSION_SPLIT workgroups.
struct OcclusionJob {
    uvec3 brick;
    uint slot;
    uint around;  ///< index of the first of the bricks around it in their list, x fastest
};

/// A sample along a ray: one cell's opacity, applied to `stretch` units of the ray.
struct OcclusionTap {
    float distance;
    float lift;  ///< offset along the normal; keeps grazing rays, and large cells, out of the surface
    float stretch;
};

/// Parameters for gathering the surroundings of bricks of one level.
struct OcclusionGatherParams {
    OcclusionCellsParams voxels;
    uvec3 cell_counts;  ///< of the leap grid
    uint reach;
    uint aprons[OCCLUSION_SIZES];  ///< in cells of each size
    float exponent;                ///< maps the path length through a cell to the stretch of its taps
};

/// Opacity of a voxel's eight octants: 8 bits for their maximum, coded as in cells, and 3 bits for each octant, in
/// sevenths of the maximum. Uniform and empty media are exact.
SHARED_FUNCTION float near_opacity(uint packed, uint octant)
{
    const float greatest = float(packed & 255u);
    return greatest * greatest * float(packed >> (8u + 3u * octant) & 7u) * (1.0f / (7.0f * 65025.0f));
}

/// Converts values to the share of ambient light: 1 - strength (1 - value^curve), which maps 1 to 1.
struct OcclusionLook {
    float strength;
    float curve;
};

SHARED_END
#endif
