// Copies bricks into their slots: one workgroup per slice of a brick's codes; the first groups also copy cell ranges.
// Copy commands would do the same, but some drivers run a dispatch for each slice of each copy.
// FILTERED: the atlas is made for the device's filter. Otherwise, staged codes have the atlas's own layout.
// BY_ADDRESS: the atlas is a buffer (library/atlas.glsl).
// variants: FILTERED BY_ADDRESS
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#include "../brick_unpack.h"
#include "../library/to_int.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;
layout(binding = 0, scalar) readonly buffer Staged { uint words[]; } staged;
layout(binding = 1, scalar) readonly buffer Jobs { BrickUnpackJob list[]; } jobs;
#ifdef FILTERED
layout(binding = 2, r16) uniform writeonly image3D atlas;
#elif defined(BY_ADDRESS)
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer AtlasWords { uint at[]; };
layout(binding = 2, scalar) readonly buffer Atlas {
    AtlasWords words;
    uvec3 size;
} atlas;
#else
layout(binding = 2, r32ui) uniform writeonly uimage3D atlas;
#endif
layout(binding = 3, r32ui) uniform writeonly uimage3D cell_ranges;

#ifdef FILTERED
const uint CODE_BYTES = 2u;
#else
layout(constant_id = 0) const uint CODE_BYTES = 2u;   // library/atlas.glsl
#endif

void main()
{
    const BrickUnpackJob job = jobs.list[gl_GlobalInvocationID.z];
    const uint z = gl_GlobalInvocationID.y;
    const uint codes_a_word = 4u / CODE_BYTES, width = job.extent.x / codes_a_word, words = width * job.extent.y;
    const uint end = z < job.extent.z ? words : 0u;
    for (uint i = gl_LocalInvocationID.x; i < end; i += UNPACK_THREADS) {
        const uint row = to_uint((float(i) + 0.5) / float(width));   // i / width, which CPU devices do lane by lane
        const uvec2 at = uvec2(i - width * row, row);
        const uint word = staged.words[job.codes + i + words * z];
#ifdef FILTERED
        const ivec3 texel = ivec3(job.code + uvec3(2u * at.x, at.y, z));
        imageStore(atlas, texel, vec4(float(word & 0xffffu) / 65535.0));
        imageStore(atlas, texel + ivec3(1, 0, 0), vec4(float(word >> 16) / 65535.0));
#elif defined(BY_ADDRESS)
        const uvec3 texel = job.code / uvec3(codes_a_word, 1u, 1u) + uvec3(at, z);
        atlas.words.at[grid_index(texel, atlas.size)] = word;
#else
        imageStore(atlas, ivec3(job.code / uvec3(codes_a_word, 1u, 1u) + uvec3(at, z)), uvec4(word));
#endif
    }
    if (z >= BRICK_CELLS) return;
    for (uint i = gl_LocalInvocationID.x; i < BRICK_CELLS * BRICK_CELLS; i += UNPACK_THREADS)
        imageStore(cell_ranges, ivec3(job.cell + uvec3(i % BRICK_CELLS, i / BRICK_CELLS, z)),
                   uvec4(staged.words[job.ranges + i + BRICK_CELLS * BRICK_CELLS * z]));
}
