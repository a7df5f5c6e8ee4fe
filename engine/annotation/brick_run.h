#pragma once
// Runs of consecutive voxels of a brick, x fastest, as records of changes hold them. Any thread.

#include <cstdint>

#include "engine/volume/grid.h"
#include "engine/volume/volume.h"
#include "shaders/bricks.h"

namespace shvr {

/// Whether all voxels from `first` to `last` lie in the volume, of which the brick holds `extent` voxels along each axis.
inline bool run_is_inside(int64_t first, int64_t last, const Size3& extent)
{
    const Size3 begin(first % BRICK_SIDE, first / BRICK_SIDE % BRICK_SIDE, first / (BRICK_SIDE * BRICK_SIDE));
    const Size3 end(last % BRICK_SIDE, last / BRICK_SIDE % BRICK_SIDE, last / (BRICK_SIDE * BRICK_SIDE));
    // A run that goes on in the next row, or slice, passes through all that lies between the two.
    const bool rows_are_full = extent.x == BRICK_SIDE || first / BRICK_SIDE == last / BRICK_SIDE;
    const bool slices_are_full = extent.y == BRICK_SIDE || begin.z == end.z;
    return rows_are_full && slices_are_full && glm::all(glm::lessThan(begin, extent)) &&
           glm::all(glm::lessThan(end, extent));
}

}  // namespace shvr
