// The leap grid: for every cell of 4^3 voxels, how far a ray may jump, whether it is painted, and which brick holds it.
//
// An entry is (distance << 25) | (painted << 24) | slot. Painted: a voxel of the cell (or, with smooth borders, next to
// the cell) is in a group; samples in unpainted cells need not read the mask. Distance 0: something visible may be in
// the cell. Distance D > 0: every cell within Chebyshev distance D - 1 is empty, so a ray may leave the cube of 2 D - 1
// cells around the cell without sampling.
#ifndef SHVR_LEAP_H
#define SHVR_LEAP_H
#include "bricks.h"

SHARED_BEGIN

SHARED_CONST uint LEAP_SLOT_MASK = 0x00ffffffu;
SHARED_CONST uint LEAP_PAINTED = 1u << 24u;
SHARED_CONST uint LEAP_DISTANCE_SHIFT = 25u;
/// Maximum distance searched: a leap of 15 cells crosses 60 voxels.
SHARED_CONST uint LEAP_LIMIT = 15u;
/// While the grid is built, its stages hand on a byte for each cell, (distance << 1) | painted, in words of four cells
/// along x, the first one in the lowest byte.
SHARED_CONST uint LEAP_WORD_CELLS = 4u;
SHARED_CONST uint LEAP_BYTE_PAINTED = 1u;
SHARED_CONST uint LEAP_BYTE_SHIFT = 1u;

/// Tolerance, in codes, by which a sample may exceed its cell's range. With it, pictures with and without skipping are
/// equal, bit for bit. Exact sampling is a few ulp off; a device's filter may be off by a code.
SHARED_CONST float GUARD_EXACT = 0.02f;
SHARED_CONST float GUARD_FILTERED = 1.5f;

/// Determines whether a cell is empty under the current transfer function.
struct OccupancyParams {
    uvec3 cell_begin;  ///< the cells to compute
    uvec3 cell_end;
    uvec3 brick_counts;
    float table_lower;  ///< as in RaycastParams
    float table_upper;
    float table_scale;
    uint table_entries;
    float guard;          ///< GUARD_EXACT or GUARD_FILTERED
    uint skipping;        ///< 0: every cell counts as occupied
    uint empty_distance;  ///< distance for cells that are not occupied
    uint paint_reach;     ///< distance in voxels (0 or 1) up to which the group of a painted voxel may be visible
};

struct LeapBoundParams {
    uvec3 cell_begin;  ///< the cells to compute
    uvec3 cell_end;
    uvec3 changed_begin;
    uvec3 changed_end;
};

SHARED_CONST uint SAMPLE_BITS_AHEAD = 24u;
SHARED_CONST uint SAMPLE_BIT_PARTS = 32768u;
/// Maximum voxels along z if sample bits are used: scaled positions must fit in 31 bits. Along y, four times as many.
SHARED_CONST uint SAMPLE_BITS_SIZE = 4095u;
SHARED_CONST float SAMPLE_BITS_REACH = 4.0f;

/// A sample bit is set if a sample may show anything, given the eight voxels around the sample. A sample uses the bit
/// of the upper of these voxels, floor(position - 0.5) + 1, at most the volume's last voxel. A cell has two texels,
/// with two planes along z each: bit x + 4 y + 16 z.
///
/// Rays find the places of SAMPLE_BITS_AHEAD samples in fixed point: SAMPLE_BIT_PARTS parts of a voxel along x, four
/// times as many along y and sixteen times along z. The rounding to parts, plus the error of a sample's own
/// coordinates, may assign the sample to a neighbouring voxel. The bits allow for this on rays whose ends are at most
/// SAMPLE_BITS_REACH times the volume's longest side apart, along each axis; other rays do not use the bits.
struct SampleBitsParams {
    uvec3 cell_begin;  ///< the cells to compute
    uvec3 cell_end;
    float lower, upper;  ///< range of visible codes
};

struct LeapDistanceParams {
    uvec3 word_counts;
    uvec3 word_begin;  ///< the words to compute
    uvec3 word_end;
    uint axis;
};

SHARED_END
#endif
