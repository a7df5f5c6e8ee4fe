// One word per thread: marks roots of components that contain a seed. A seed is a set voxel of the region that is also
// set in the previous object's bits; the box of these bits may be anywhere relative to the region.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "regions.h"

layout(local_size_x = 1, local_size_y = 8, local_size_z = 8) in;
layout(push_constant, scalar) uniform Push { SeedParams params; };
layout(binding = 0, scalar) readonly buffer Bits { uint words[]; } bits;
layout(binding = 1, scalar) readonly buffer Parents { uint of[]; } parents;
layout(binding = 2, scalar) readonly buffer Seeds { uint words[]; } seeds;
layout(binding = 3, scalar) buffer Marked { uint words[]; } marked;   // one bit per voxel, set at roots

#include "forest.glsl"
#include "region.glsl"

// Returns a word of the seeds' row, without bits beyond the row's end.
uint seed_word(int word, int row)
{
    if (word < 0 || word >= int(params.seed_words_per_row)) return 0u;
    return seeds.words[word + row * int(params.seed_words_per_row)] & span_bits(0, int(params.seed_size.x), 32 * word);
}

void main()
{
    const uvec3 at = gl_GlobalInvocationID;
    if (outside_region(at)) return;
    const ivec3 from = ivec3(at.x * 32u, at.yz) + params.to_seeds;   // voxel of the seeds' box
    if (from.y < 0 || from.z < 0 || from.y >= int(params.seed_size.y) || from.z >= int(params.seed_size.z)) return;
    const int row = from.y + int(params.seed_size.y) * from.z, first = from.x >> 5, shift = from.x & 31;
    uint other = seed_word(first, row) >> shift;
    if (shift != 0) other |= seed_word(first + 1, row) << (32 - shift);
    const uint index = word_index(at);
    const uint word = bits.words[index];
    for (uint found = word & other; found != 0u; found &= found - 1u) {
        const uint root = find_root(index * 32u + run_start(word, uint(findLSB(found))));
        atomicOr(marked.words[root >> 5], 1u << (root & 31u));
    }
}
