// Counters, 64 bits wide on devices without 64-bit atomics: a carry is added when the low half wraps.
#include "../counters.h"

layout(binding = 15, scalar) buffer Counters { uvec2 values[]; } counters;

void count(uint counter, uint amount)
{
    if (amount == 0u) return;
    const uint before = atomicAdd(counters.values[counter].x, amount);
    if (before + amount < before) atomicAdd(counters.values[counter].y, 1u);
}
