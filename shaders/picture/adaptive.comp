// Decides which blocks of a picture must be drawn pixel by pixel, and interpolates the pixels of all others from the
// coarse picture (adaptive.h). One thread per block.
//
// A block is drawn if the largest and the smallest value of the coarse pixels in it and next to it differ by more than
// the tolerance, in any channel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "../adaptive.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push
{
    AdaptiveParams params;
};
layout(binding = 0, rgba32f) uniform readonly image2D coarse;
layout(binding = 1, rgba32f) uniform writeonly image2D color;
layout(binding = 2, scalar) writeonly buffer Blocks { uint numbers[]; } blocks;
// Three words per dispatch, the group counts along each axis; the last word is the number of blocks in the list.
layout(binding = 3, scalar) buffer Dispatches { uint words[]; } dispatches;

const ivec2 AROUND = ivec2(ADAPTIVE_BLOCK_X, ADAPTIVE_BLOCK_Y) / 2 + 1;   // neighbourhood in pixels of the coarse
                                                                          // picture

void list(uint block)
{
    const uint at = atomicAdd(dispatches.words[dispatches.words.length() - 1], 1u);
    blocks.numbers[at] = block;
    if (at % ADAPTIVE_BLOCKS_IN_GROUP > 0u) return;
    const uint group = at / ADAPTIVE_BLOCKS_IN_GROUP, words = 3u * (group / params.groups_in_dispatch);
    atomicAdd(dispatches.words[words], 1u);
    if (group % params.groups_in_dispatch == 0u) dispatches.words[words + 1u] = dispatches.words[words + 2u] = 1u;
}

void store(uvec2 pixel, vec4 light)
{
    if (any(lessThan(pixel, params.pixel_begin)) || any(greaterThanEqual(pixel, params.pixel_end))) return;
    imageStore(color, ivec2(params.target + (pixel - params.pixel_begin)), light);
}

void main()
{
    const uvec2 first = adaptive_begin(params.pixel_begin);
    const uvec2 count = adaptive_blocks(params.pixel_begin, params.pixel_end), at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, count))) return;
    const uvec2 pixel = first + at * uvec2(ADAPTIVE_BLOCK_X, ADAPTIVE_BLOCK_Y);

    const ivec2 begin = ivec2(pixel - first) / 2;
    vec4 light[AROUND.y][AROUND.x];
    vec4 least = vec4(1.0), most = vec4(0.0);
    [[unroll]] for (int y = 0; y < AROUND.y; ++y)
        [[unroll]] for (int x = 0; x < AROUND.x; ++x) {
            light[y][x] = imageLoad(coarse, begin + ivec2(x, y));
            const vec4 seen = sqrt(clamp(light[y][x], 0.0, 1.0));
            least = min(least, seen);
            most = max(most, seen);
        }
    if (any(greaterThan(most - least, vec4(params.tolerance)))) {
        list(at.y * count.x + at.x);
        return;
    }
    [[unroll]] for (int y = 0; y < int(ADAPTIVE_BLOCK_Y); ++y)
        [[unroll]] for (int x = 0; x < int(ADAPTIVE_BLOCK_X); ++x) {
            const ivec2 low = ivec2(x, y) / 2, high = (ivec2(x, y) + 1) / 2;
            store(pixel + uvec2(x, y), 0.25 * (light[low.y][low.x] + light[low.y][high.x] + light[high.y][low.x] +
                                               light[high.y][high.x]));
        }
}
