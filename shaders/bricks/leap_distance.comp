// One axis of the Chebyshev distance transform. The maximum norm is separable, so three such passes are exact. They
// hand on bytes (leap.h).
// LAST: writes the entries of the grid.
// variants: LAST
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../leap.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { LeapDistanceParams params; };
layout(binding = 0, r8ui) uniform readonly uimage3D source;
#ifdef LAST
layout(binding = 1, r32ui) uniform writeonly uimage3D leap;
layout(binding = 2, scalar) readonly buffer PageTable { uint slots[]; } page_table;
#else
layout(binding = 1, r8ui) uniform writeonly uimage3D leap;
#endif

void main()
{
    const ivec3 cell = ivec3(params.cell_begin + gl_GlobalInvocationID);
    const ivec3 counts = ivec3(params.cell_counts);
    if (any(greaterThanEqual(cell, ivec3(params.cell_end)))) return;
    const ivec3 along = ivec3(params.axis == 0u, params.axis == 1u, params.axis == 2u);
    const int position = params.axis == 0u ? cell.x : params.axis == 1u ? cell.y : cell.z;
    const int count = params.axis == 0u ? counts.x : params.axis == 1u ? counts.y : counts.z;

    const uint byte = imageLoad(source, cell).x;
    uint best = byte >> LEAP_BYTE_SHIFT;
    for (uint k = 1u; k < best; ++k) {
        // Cells beyond the border are empty. Clamped reads repeat a nearer cell, which cannot change the result.
        const int below = max(-int(k), -position), above = min(int(k), count - 1 - position);
        const uint nearest = min(imageLoad(source, cell + below * along).x, imageLoad(source, cell + above * along).x);
        best = min(best, max(k, nearest >> LEAP_BYTE_SHIFT));
    }
    const bool painted = (byte & LEAP_BYTE_PAINTED) != 0u;
#ifdef LAST
    const uint slot = page_table.slots[grid_index(uvec3(cell) / BRICK_CELLS, params.cell_counts / BRICK_CELLS)];
    imageStore(leap, cell, uvec4(best << LEAP_DISTANCE_SHIFT | (painted ? LEAP_PAINTED : 0u) | slot));
#else
    imageStore(leap, cell, uvec4(best << LEAP_BYTE_SHIFT | (painted ? LEAP_BYTE_PAINTED : 0u)));
#endif
}
