// Paged bricks: how a ray finds the finest brick that is loaded.
//
// The directory is a dense grid of cells of 2^cell_shift voxels a side, followed by blocks of eight children. An entry
// is
//   distance << 28 | level << 24 | payload
// Distance D > 0: nothing is visible in the cube of 2 D - 1 grid cells around this cell. Otherwise, level PAGE_NODE:
// the payload is the index of the first of eight entries, x fastest, for the cell's octants. With any other level, the
// payload is the slot (pack_slot) of a brick of this level that contains the cell: the finest brick loaded, perhaps
// coarser than wanted. A ray that reaches level PAGE_MISSING waits.
//
// Within a brick, `cell_leap` describes its 8^3 cells: distance << 1 | painted. The distance is the Chebyshev distance
// to the nearest cell of the brick that may contain something visible, or to the brick's end; if `painted` is 0, no
// voxel of the cell is in a group.
#ifndef SHVR_PAGES_H
#define SHVR_PAGES_H
#include "leap.h"

SHARED_BEGIN

SHARED_CONST uint PAGE_DISTANCE_SHIFT = 28u;
SHARED_CONST uint PAGE_LEVEL_SHIFT = 24u;
SHARED_CONST uint PAGE_NODE = 15u;
SHARED_CONST uint PAGE_PAYLOAD_MASK = 0x00ffffffu;
SHARED_CONST uint CELL_PAINTED = 1u;
SHARED_CONST uint CELL_DISTANCE_SHIFT = 1u;
/// The brick is not on the device and no coarser brick stands in: only while rays wait (RaycastInput::waiting).
SHARED_CONST uint PAGE_MISSING = 14u;
/// Maximum number of cells of the directory's grid along an axis. The grid is rebuilt for every new view.
SHARED_CONST uint PAGE_GRID = 32u;

/// A brick whose cells are examined by one workgroup.
struct BrickLeapJob {
    uvec3 brick;  ///< in bricks of its level
    uint level;
    uint slot;
    uint mask_slot;  ///< 0: the brick has no painted voxel, nor (with a larger paint reach) have its neighbours
};

/// Like OccupancyParams, for bricks anywhere in the atlas.
struct BrickLeapParams {
    float table_lower;
    float table_upper;
    float table_scale;
    uint table_entries;
    float guard;
    uint skipping;
    uint paint_reach;
};

SHARED_END
#endif
