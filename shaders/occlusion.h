// Local ambient occlusion: how much light reaches a voxel from the space around it, as far as a radius (Hernell, Ljung and
// Ynnerman 2007). Lengths are in units of the brick's level: 2^level reference lengths.
//
// "Cells" are what light meets on its way, three copies of every brick: voxels, and the means of 2^3 and 4^3 of them. A
// cell's code says how opaque the way through it is, of 1, 2 or 4 units: opacity = (code / 255)^2. The square root spends the
// codes where opacities are small. The mean is one of opacities of that way, not of extinction: half of a cell behind
// a surface stops half of the light, however dense it is.
//
// "Values" are the result, 255 where all light arrives, in slots like those of the density atlas, aprons included.
#ifndef SHVR_OCCLUSION_H
#define SHVR_OCCLUSION_H
#include "bricks.h"

SHARED_BEGIN

SHARED_CONST uint OCCLUSION_SIZES = 3u;
SHARED_CONST uint OCCLUSION_MOST_TAPS = 7u;
/// Bricks on each side of one that its light may come from, at most; sets the largest radius.
SHARED_CONST uint OCCLUSION_REACH = 2u;
SHARED_CONST uint OCCLUSION_AROUND = 125u;  // (2 OCCLUSION_REACH + 1)^3
/// Workgroups that share a brick: more of them keep a GPU busy with few bricks, each costs a look at all of its cells.
SHARED_CONST uint OCCLUSION_SPLIT = 4u;
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
    uvec3 mask_slots;
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

struct OcclusionParams {
    vec3 inverse_spacing;  ///< voxels per unit
    float radius;
    float first;          ///< units that light always passes: no voxel shadows itself
    float gradient_fade;  ///< codes per unit; 0 gradients, and all where `full_sphere`, have no hemisphere
    uint full_sphere;
    uint rays;
    uint reach;
    uint taps_end[OCCLUSION_SIZES];  ///< taps of each size of cells end here
    uint grow;          ///< 1: voxels beside those of occupied cells, too (painted ones show outside the cells' ranges)
    uvec3 cell_counts;  ///< of the leap grid
};

/// How values become the ambient light's share: 1 - strength (1 - value^curve), which keeps 1.
struct OcclusionLook {
    float strength;
    float curve;
};

SHARED_END
#endif
