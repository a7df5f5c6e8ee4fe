// Counters of a workgroup, added up before they reach memory: all rays of a picture add to the same few words. Needs
// `count`. Both ends in uniform control flow.

const uint GROUP_COUNTERS = COUNTER_DENSITY_READS + 1u;
shared uint of_group[GROUP_COUNTERS];   // of 64 rays; a block of a ray's steps has less than 2^24 reads

void begin_group_counts()
{
    if (gl_LocalInvocationIndex < GROUP_COUNTERS) of_group[gl_LocalInvocationIndex] = 0u;
    barrier();
}

void count_in_group(uint counter, uint amount)
{
    if (amount != 0u) atomicAdd(of_group[counter], amount);
}

void end_group_counts()
{
    barrier();
    if (gl_LocalInvocationIndex < GROUP_COUNTERS) count(gl_LocalInvocationIndex, of_group[gl_LocalInvocationIndex]);
}
