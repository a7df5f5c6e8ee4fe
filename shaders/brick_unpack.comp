// Puts bricks into their slots: a group for each slice of a brick's codes; the first ones bring the cells as well.
// Copies would do the same, but some devices run a dispatch for each slice of each.
// FILTERED: the atlas is the one for the device's filter.
// variants: FILTERED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "brick_unpack.h"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;
layout(binding = 0, scalar) readonly buffer Staged { uint words[]; } staged;
layout(binding = 1, scalar) readonly buffer Jobs { BrickUnpackJob list[]; } jobs;
#ifdef FILTERED
layout(binding = 2, r16) uniform writeonly image3D atlas;
#else
layout(binding = 2, r32ui) uniform writeonly uimage3D atlas;
#endif
layout(binding = 3, r32ui) uniform writeonly uimage3D cell_ranges;

const uint PAIRS = BRICK_TEXELS / 2u;

void main()
{
    const BrickUnpackJob job = jobs.list[gl_GlobalInvocationID.z];
    const uint z = gl_GlobalInvocationID.y;
    for (uint i = gl_LocalInvocationID.x; i < PAIRS * BRICK_TEXELS; i += UNPACK_THREADS) {
        const uvec2 at = uvec2(i % PAIRS, i / PAIRS);
        const uint pair = staged.words[job.codes + i + PAIRS * BRICK_TEXELS * z];
#ifdef FILTERED
        const ivec3 texel = ivec3(job.texel + uvec3(2u * at.x, at.y, z));
        imageStore(atlas, texel, vec4(float(pair & 0xffffu) / 65535.0));
        imageStore(atlas, texel + ivec3(1, 0, 0), vec4(float(pair >> 16) / 65535.0));
#else
        imageStore(atlas, ivec3(job.texel / uvec3(2u, 1u, 1u) + uvec3(at, z)), uvec4(pair));
#endif
    }
    if (z >= BRICK_CELLS) return;
    for (uint i = gl_LocalInvocationID.x; i < BRICK_CELLS * BRICK_CELLS; i += UNPACK_THREADS)
        imageStore(cell_ranges, ivec3(job.cell + uvec3(i % BRICK_CELLS, i / BRICK_CELLS, z)),
                   uvec4(staged.words[job.ranges + i + BRICK_CELLS * BRICK_CELLS * z]));
}
