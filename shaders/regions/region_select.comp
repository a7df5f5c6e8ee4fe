// One word per thread: keeps the runs of the seed's component, the runs with an unmarked root, or the runs with a
// marked root.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "regions.h"

layout(local_size_x = 1, local_size_y = 8, local_size_z = 8) in;
layout(constant_id = 0) const uint KEEP = KEEP_SEED;   // regions.h
layout(push_constant, scalar) uniform Push { RegionParams params; };
layout(binding = 0, scalar) readonly buffer Bits { uint words[]; } bits;
layout(binding = 1, scalar) readonly buffer Parents { uint of[]; } parents;
layout(binding = 2, scalar) readonly buffer Marked { uint words[]; } marked;
layout(binding = 3, scalar) writeonly buffer Selected { uint words[]; } selected;

#include "forest.glsl"
#include "region.glsl"

void main()
{
    const uvec3 at = gl_GlobalInvocationID;
    if (outside_region(at)) return;
    const uint index = word_index(at);
    const uint word = bits.words[index];
    uint wanted_root = NO_SEED;
    if (KEEP == KEEP_SEED && params.seed != NO_SEED) {
        const uint seed_word = bits.words[params.seed >> 5];
        if ((seed_word >> (params.seed & 31u) & 1u) != 0u)
            wanted_root = find_root((params.seed & ~31u) + run_start(seed_word, params.seed & 31u));
    }
    uint result = 0u;
    for (uint starts = word & ~(word << 1); starts != 0u; starts &= starts - 1u) {
        const uint start = uint(findLSB(starts));
        const uint root = find_root(index * 32u + start);
        const bool keep = KEEP == KEEP_SEED ? root == wanted_root :
                          (marked.words[root >> 5] >> (root & 31u) & 1u) == (KEEP == KEEP_MARKED ? 1u : 0u);
        const uint after = ~word & ~((1u << start) - 1u);                       // clear bits above the start
        const uint end = after == 0u ? 32u : uint(findLSB(after));
        if (keep) result |= span_bits(int(start), int(end), 0);
    }
    selected.words[index] = result;
}
