// Counters with 64 bits on devices without 64-bit atomics: a carry is added when the low half wraps around. Each
// workgroup counts in its own row as long as there are enough rows, since atomic additions to one address are
// serialized. The host adds up the rows.
#include "../counters.h"

layout(binding = 15, scalar) buffer Counters { uvec2 values[]; } counters;

void count(uint counter, uint amount)
{
    if (amount == 0u) return;
    const uint rows = uint(counters.values.length()) / COUNTERS_IN_ROW;
    const uint at = counter_row(gl_WorkGroupID, rows) * COUNTERS_IN_ROW + counter;
    const uint before = atomicAdd(counters.values[at].x, amount);
    if (before + amount < before) atomicAdd(counters.values[at].y, 1u);
}
