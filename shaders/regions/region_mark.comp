// One word per thread: marks roots of components that contain an edge voxel (one with a face neighbour outside).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "regions.h"

layout(local_size_x = 1, local_size_y = 8, local_size_z = 8) in;
layout(push_constant, scalar) uniform Push { RegionParams params; };
layout(binding = 0, scalar) readonly buffer Bits { uint words[]; } bits;
layout(binding = 1, scalar) readonly buffer Parents { uint of[]; } parents;
layout(binding = 2, scalar) readonly buffer Rows { RowSpan spans[]; } rows;
layout(binding = 3, scalar) buffer Marked { uint words[]; } marked;   // one bit per voxel, set at roots

#include "forest.glsl"
#include "region.glsl"

uint row_bits(ivec2 row, int first)
{
    if (any(lessThan(row, ivec2(0))) || any(greaterThanEqual(row, ivec2(params.size.yz)))) return 0u;
    const RowSpan span = rows.spans[row.x + int(params.size.y) * row.y];
    return span_bits(span.begin, span.end, first);
}

void main()
{
    const uvec3 at = gl_GlobalInvocationID;
    if (outside_region(at)) return;
    const int first = int(at.x) * 32;
    const ivec2 row = ivec2(at.yz);
    const RowSpan span = rows.spans[at.y + params.size.y * at.z];
    const uint inner = span_bits(span.begin + 1, span.end - 1, first) & row_bits(row + ivec2(-1, 0), first) &
                       row_bits(row + ivec2(1, 0), first) & row_bits(row + ivec2(0, -1), first) &
                       row_bits(row + ivec2(0, 1), first);
    const uint index = word_index(at);
    const uint word = bits.words[index];
    for (uint edge = word & ~inner; edge != 0u; edge &= edge - 1u) {
        const uint root = find_root(index * 32u + run_start(word, uint(findLSB(edge))));
        atomicOr(marked.words[root >> 5], 1u << (root & 31u));
    }
}
