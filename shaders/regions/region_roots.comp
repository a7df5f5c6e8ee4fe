// Prepares bits from elsewhere (for touch: bits of any level, from the device or the host) for the labelling of a
// region: clears bits beyond the end of a row, and makes every run its own root. One word per thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "regions.h"

layout(local_size_x = 1, local_size_y = 8, local_size_z = 8) in;
layout(push_constant, scalar) uniform Push { RegionParams params; };
layout(binding = 0, scalar) readonly buffer Mask { uint words[]; } mask;
layout(binding = 1, scalar) writeonly buffer Bits { uint words[]; } bits;
layout(binding = 2, scalar) writeonly buffer Parents { uint of[]; } parents;

#include "region.glsl"

void main()
{
    const uvec3 word = gl_GlobalInvocationID;
    if (outside_region(word)) return;
    const uint index = word_index(word);
    const int first = int(word.x) * 32;
    const uint result = mask.words[index] & span_bits(0, int(params.size.x), first);
    bits.words[index] = result;
    for (uint starts = result & ~(result << 1); starts != 0u; starts &= starts - 1u) {
        const uint start = index * 32u + uint(findLSB(starts));
        parents.of[start] = start;
    }
}
