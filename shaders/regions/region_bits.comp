// One word per thread: sets the bits of voxels at or above the threshold; every run of bits becomes a root.
// FILTERED: reads the atlas made for the device's filter.
// variants: FILTERED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#include "regions.h"

layout(local_size_x = 1, local_size_y = 8, local_size_z = 8) in;
layout(constant_id = 0) const uint IN_SLOTS = 0u;   // for paged bricks
layout(push_constant, scalar) uniform Push { RegionParams params; };
#ifdef FILTERED
layout(binding = 0) uniform sampler3D atlas;
#else
layout(binding = 0, r32ui) uniform readonly uimage3D atlas;
#endif
layout(binding = 1, scalar) readonly buffer RegionBricks { uint slots[]; } region_bricks;
layout(binding = 2, scalar) readonly buffer Rows { RowSpan spans[]; } rows;
layout(binding = 3, scalar) writeonly buffer Bits { uint words[]; } bits;
layout(binding = 4, scalar) writeonly buffer Parents { uint of[]; } parents;

#define STACKED 5
#include "../library/voxel_code.glsl"
#include "../library/to_int.glsl"
#include "region.glsl"

uint code_of(uvec3 voxel)
{
    if (IN_SLOTS == 0u) return to_uint(code_at(place_of_first() + ivec3(voxel)));
    const uint slot = region_bricks.slots[grid_index(voxel / BRICK_SIZE - params.brick_begin, params.brick_counts)];
    return to_uint(code_at(place_in_slot(slot) + ivec3(voxel % BRICK_SIZE)));
}

void main()
{
    const uvec3 word = gl_GlobalInvocationID;
    if (outside_region(word)) return;
    const RowSpan span = rows.spans[word.y + params.size.y * word.z];
    const int first = int(word.x) * 32;
    const int end = min(span.end, first + 32);
    uint result = 0u;
    for (int x = max(span.begin, first); x < end; ++x)
        if (code_of(params.origin + uvec3(uint(x), word.yz)) >= params.threshold_code) result |= 1u << uint(x - first);

    const uint index = word_index(word);
    bits.words[index] = result;
    for (uint starts = result & ~(result << 1); starts != 0u; starts &= starts - 1u) {
        const uint start = index * 32u + uint(findLSB(starts));
        parents.of[start] = start;
    }
}
