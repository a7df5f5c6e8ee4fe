// Source and destination of a brick for brick_unpack.comp.
#ifndef SHVR_BRICK_UNPACK_H
#define SHVR_BRICK_UNPACK_H
#include "bricks.h"

SHARED_BEGIN

SHARED_CONST uint UNPACK_THREADS = 64u;  // per slice of a brick

struct BrickUnpackJob {
    uvec3 code;    ///< texel of the brick's first code
    uint codes;    ///< the first staged word of the brick's codes
    uvec3 extent;  ///< in codes
    uvec3 cell;    ///< texel of the brick's first cell
    uint ranges;   ///< the first word of the cells' ranges
};

SHARED_END
#endif
