// One axis of the Chebyshev distance transform, for a word of four cells along x per thread (leap.h). The maximum norm
// is separable, so three such passes are exact.
// LAST: writes the entries of the grid.
// variants: LAST
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../leap.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { LeapDistanceParams params; };
layout(binding = 0, r32ui) uniform readonly uimage3D source;
layout(binding = 1, r32ui) uniform writeonly uimage3D leap;
#ifdef LAST
layout(binding = 2, scalar) readonly buffer PageTable { uint slots[]; } page_table;
#endif

const uint EACH_BYTE = 0x01010101u, TOP_BITS = 0x80808080u;

// 0xff for each byte in which a >= b; all bytes are below 128.
uint bytes_at_least(uint a, uint b)
{
    return (((a | TOP_BITS) - b & TOP_BITS) >> 7) * 0xffu;
}

uint smaller_bytes(uint a, uint b)
{
    return a ^ (a ^ b) & bytes_at_least(a, b);
}

uint larger_bytes(uint a, uint b)
{
    return b ^ (a ^ b) & bytes_at_least(a, b);
}

uint largest_of_bytes(uint word)
{
    return max(max(word & 0xffu, word >> 8 & 0xffu), max(word >> 16 & 0xffu, word >> 24));
}

uint distances_in(uint word)
{
    return word >> LEAP_BYTE_SHIFT & 0x7fu * EACH_BYTE;
}

// A bit for each cell of a word: whether it is occupied. Before the first pass a distance is 0 or LEAP_LIMIT, which is
// odd. Cells beyond the border are empty.
uint occupied_cells(ivec3 word)
{
    if (word.x < 0 || word.x >= int(params.word_counts.x)) return 0u;
    const uint is_occupied = ~distances_in(imageLoad(source, word).x) & EACH_BYTE;
    return is_occupied * 0x01020408u >> 24 & 0xfu;
}

uint distances_along_x(ivec3 word)
{
    const int WORDS = int((LEAP_LIMIT + LEAP_WORD_CELLS - 1u) / LEAP_WORD_CELLS);  // on each side
    const int CELLS = int(LEAP_WORD_CELLS), FIRST = WORDS * CELLS;
    const uint here = occupied_cells(word);
    uint before = here << FIRST, behind = here;  // up to the word; from the word on
    for (int k = 1; k <= WORDS; ++k) {
        before |= occupied_cells(word - ivec3(k, 0, 0)) << FIRST - CELLS * k;
        behind |= occupied_cells(word + ivec3(k, 0, 0)) << CELLS * k;
    }
    uint distances = 0u;
    for (int i = 0; i < CELLS; ++i) {
        const uint left = before & (2u << FIRST + i) - 1u, right = behind >> i;
        const uint to_left = left == 0u ? LEAP_LIMIT : uint(FIRST + i - findMSB(left));
        const uint to_right = right == 0u ? LEAP_LIMIT : uint(findLSB(right));
        distances |= min(min(to_left, to_right), LEAP_LIMIT) << 8 * i;
    }
    return distances;
}

// `before`: the distances of the word's cells after the passes along other axes.
uint distances_along(ivec3 along, ivec3 word, uint before)
{
    const int position = along.y != 0 ? word.y : word.z;
    const int count = int(along.y != 0 ? params.word_counts.y : params.word_counts.z);
    uint best = before;
    for (uint k = 1u; k < largest_of_bytes(best); ++k) {
        // Cells beyond the border are empty. Clamped reads repeat a nearer cell, which cannot change the result.
        const int below = max(-int(k), -position), above = min(int(k), count - 1 - position);
        const uint nearest = smaller_bytes(distances_in(imageLoad(source, word + below * along).x),
                                           distances_in(imageLoad(source, word + above * along).x));
        best = smaller_bytes(best, larger_bytes(k * EACH_BYTE, nearest));
    }
    return best;
}

void main()
{
    const ivec3 word = ivec3(params.word_begin + gl_GlobalInvocationID);
    if (any(greaterThanEqual(word, ivec3(params.word_end)))) return;
    const uint before = imageLoad(source, word).x;
    const ivec3 along = ivec3(0, params.axis == 1u, params.axis == 2u);
    const uint distances =
        params.axis == 0u ? distances_along_x(word) : distances_along(along, word, distances_in(before));
#ifdef LAST
    const uvec3 counts = params.word_counts * uvec3(LEAP_WORD_CELLS, 1u, 1u);
    const uvec3 first = uvec3(word) * uvec3(LEAP_WORD_CELLS, 1u, 1u);
    const uint slot = page_table.slots[grid_index(first / BRICK_CELLS, counts / BRICK_CELLS)];
    for (uint i = 0u; i < LEAP_WORD_CELLS; ++i) {
        const uint distance = distances >> 8u * i & 0xffu;
        const bool painted = (before >> 8u * i & LEAP_BYTE_PAINTED) != 0u;
        imageStore(leap, ivec3(first) + ivec3(i, 0, 0),
                   uvec4(distance << LEAP_DISTANCE_SHIFT | (painted ? LEAP_PAINTED : 0u) | slot));
    }
#else
    imageStore(leap, word, uvec4(distances << LEAP_BYTE_SHIFT | before & LEAP_BYTE_PAINTED * EACH_BYTE));
#endif
}
