// Local ambient occlusion: how much light reaches a voxel from the space around it, as far as a radius (Hernell, Ljung
// and Ynnerman 2007). Lengths are in units of the brick's level: 2^level reference lengths.
//
// "Cells" are what light meets on its way, two copies of every brick: the means of 2^3 and 4^3 voxels. A cell's code
// says how opaque the way through it is, of 2 or 4 units: opacity = (code / 255)^2. The square root spends the codes
// where opacities are small. The mean is one of opacities of that way, not of extinction: half of a cell behind a
// surface stops half of the light, however dense it is.
//
// "Near" is what light meets at once, in steps of half a voxel: where surfaces are steep, whole voxels are too coarse
// for rays that pass close by. It is made of densities and their slopes when a brick's turn comes, with what lies
// around the brick, and then forgotten; so are copies of the cells around it, for rays to run in one piece of memory.
//
// "Values" are the result, 255 where all light arrives, in slots like those of the density atlas, aprons included.
#ifndef SHVR_OCCLUSION_H
#define SHVR_OCCLUSION_H
#include "bricks.h"

SHARED_BEGIN

SHARED_CONST uint OCCLUSION_SIZES = 2u;  // of cells: 2 << size voxels a side
SHARED_CONST uint OCCLUSION_MOST_TAPS = 6u;
/// Bricks whose values may be made at once: the scratch images hold as many, one behind the other along z.
SHARED_CONST uint OCCLUSION_SLICE = 16u;
SHARED_CONST uint OCCLUSION_NEAR_APRON = 4u;  // voxels
SHARED_CONST uint OCCLUSION_NEAR_SIDE = 40u;  // BRICK_SIZE + 2 OCCLUSION_NEAR_APRON
/// Bricks on each side of one that its light may come from, at most; sets the largest radius.
SHARED_CONST uint OCCLUSION_REACH = 2u;
SHARED_CONST uint OCCLUSION_AROUND = 125u;  // (2 OCCLUSION_REACH + 1)^3
/// Workgroups that share a brick: more of them keep a GPU busy with few bricks.
SHARED_CONST uint OCCLUSION_SPLIT = 8u;
/// An entry of `around` is the packed slot of a brick, its level above the job's shifted by this; 0: nothing is there.
SHARED_CONST uint OCCLUSION_LEVEL_SHIFT = 24u;

/// A brick whose cells are made: one workgroup.
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
    vec3 lower;  ///< what stops light, voxels of level 0; outside is nothing
    vec3 upper;
    uvec3 brick_counts;  ///< of level 0
};

/// A brick whose values are made: OCCLUSION_SPLIT workgroups.
struct OcclusionJob {
    uvec3 brick;
    uint slot;
    uint around;  ///< where the bricks around it begin in the list of them, x fastest
};

/// A look along a ray: what happens to light on `stretch` units of it, told by one cell.
struct OcclusionTap {
    float distance;
    float lift;  ///< along the normal; keeps rays that graze a surface, and large cells, out of it
    float stretch;
};

/// What is gathered around bricks of one level.
struct OcclusionGatherParams {
    OcclusionCellsParams voxels;
    uvec3 cell_counts;  ///< of the leap grid
    uint reach;
    uint aprons[OCCLUSION_SIZES];  ///< in cells of each size
    float exponent;                ///< from the way through a cell to the stretch of its taps
};

/// What stops light in a voxel's eight halves a side: 8 bits for the greatest opacity of them, as in cells, and 3 bits
/// for each of them, in sevenths of it. Even media and empty ones are exact.
SHARED_FUNCTION float near_opacity(uint packed, uint octant)
{
    const float greatest = float(packed & 255u);
    return greatest * greatest * float(packed >> (8u + 3u * octant) & 7u) * (1.0f / (7.0f * 65025.0f));
}

/// How values become the ambient light's share: 1 - strength (1 - value^curve), which keeps 1.
struct OcclusionLook {
    float strength;
    float curve;
};

SHARED_END
#endif
