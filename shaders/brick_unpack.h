// Where brick_unpack.comp takes a brick from, and where it goes.
#ifndef SHVR_BRICK_UNPACK_H
#define SHVR_BRICK_UNPACK_H
#include "bricks.h"

SHARED_BEGIN

SHARED_CONST uint UNPACK_THREADS = 64u;  // for each slice of a brick

struct BrickUnpackJob {
    uvec3 texel;  ///< the first code of its slot, apron included
    uint codes;   ///< the first word of its codes, two in a word
    uvec3 cell;   ///< its first cell
    uint ranges;  ///< the first word of its cells' ranges
};

SHARED_END
#endif
