// Work counters that a kernel may keep. The counts are exact integers, so CI compares counts and never times.
#ifndef SHVR_COUNTERS_H
#define SHVR_COUNTERS_H
#include "shared.h"

SHARED_BEGIN

SHARED_CONST uint COUNTER_RAYS = 0u;            // rays that met the volume
SHARED_CONST uint COUNTER_SAMPLES = 1u;         // density samples taken
SHARED_CONST uint COUNTER_SHADED = 2u;          // samples with a gradient
SHARED_CONST uint COUNTER_LEAPS = 3u;           // jumps over empty cells
SHARED_CONST uint COUNTER_BRICKS_VISITED = 4u;  // bricks in which a ray took a sample, added up over rays and blocks
SHARED_CONST uint COUNTER_BRICKS_SKIPPED = 5u;  // bricks that a ray crossed without a sample, added up in the same way
SHARED_CONST uint COUNTER_TERMINATED = 6u;      // rays that ended early
/// Always counted: rays that stopped before their end, once for each dispatch in which a ray did so. The picture lacks
/// everything behind the point where a ray stopped.
SHARED_CONST uint COUNTER_CUT_SHORT = 7u;
SHARED_CONST uint COUNTER_DENSITY_READS = 8u;  // texels of the atlas (or taps of its filter) that samples read
SHARED_CONST uint COUNTER_TURNS = 9u;          // iterations of the loops along a ray, except fixed-length loops

SHARED_CONST uint COUNTERS_IN_ROW = 16u;
/// The row in which a workgroup counts. Neighbouring groups use different rows. `rows` is a power of two.
SHARED_FUNCTION uint counter_row(uvec3 group, uint rows)
{
    return (group.x + 8u * group.y) & (rows - 1u);
}

/// Maximum loop iterations of one thread in a dispatch. Some devices silently abort loops after 65535 iterations.
SHARED_CONST uint MAX_TURNS = 32768u;

SHARED_END
#endif
