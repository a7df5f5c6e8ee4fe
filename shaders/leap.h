// The leap grid: for every cell of 4^3 voxels, how far a ray may jump and which brick is there.
//
// An entry is (distance << 24) | slot. Distance 0: something visible may be in the cell. Distance D > 0: every cell
// within Chebyshev distance D - 1 is empty, so a ray may leave the cube of 2 D - 1 cells around it without a sample.
#ifndef SHVR_LEAP_H
#define SHVR_LEAP_H
#include "bricks.h"

SHARED_BEGIN

SHARED_CONST uint LEAP_SLOT_MASK = 0x00ffffffu;
SHARED_CONST uint LEAP_DISTANCE_SHIFT = 24u;
/// Farther than this is not looked for: a jump of 15 cells crosses 60 voxels.
SHARED_CONST uint LEAP_LIMIT = 15u;

/// What decides whether a cell is empty under the transfer function of the moment.
struct OccupancyParams {
    uvec3 cell_begin;  ///< the cells that are computed
    uvec3 cell_end;
    uvec3 brick_counts;
    float table_lower;  ///< as in RaycastParams
    float table_upper;
    float table_scale;
    uint table_entries;
    uint skipping;     ///< 0: every cell counts as occupied
    uvec3 mask_slots;  ///< atlas of mask bricks; used with a mask
};

struct LeapDistanceParams {
    uvec3 cell_counts;
    uvec3 cell_begin;  ///< the cells that are computed
    uvec3 cell_end;
    uint axis;
};

SHARED_END
#endif
