// Finds where samples of the exact density may show something (sample bits, leap.h): one cell per thread. The bit of a
// sample between eight voxel centres is set if at least one code there is not below the visible range, and at least one
// is not above it. In a cell next to paint, all bits are set.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "../leap.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { SampleBitsParams params; };
layout(binding = 0, r32ui) uniform readonly uimage3D leap;
layout(binding = 1, r32ui) uniform readonly uimage3D atlas;
layout(binding = 2, r32ui) uniform writeonly uimage3D sample_bits;

#include "../library/atlas.glsl"

const uint ALL = 0xffffffffu;
// Returns bits for five codes: the code before `x`, and four codes from `x` on, where `x` begins a word. Bits 0 to 4:
// not below the visible range; bits 8 to 12: not above it. The volume's first voxel repeats before the row.
uint sides_of_row(int x, int y, int z)
{
    const int before = max(x - 1, 0), first_word = x >> WORD_SHIFT;
    const uint words[3] = uint[3](atlas_word(ivec3(before >> WORD_SHIFT, y, z)), atlas_word(ivec3(first_word, y, z)),
                                  CODE_BYTES == 1u ? 0u : atlas_word(ivec3(first_word + 1, y, z)));
    uint sides = 0u;
    [[unroll]] for (int i = 0; i < 5; ++i) {
        const uint word = i == 0 ? words[0] : CODE_BYTES == 1u || i < 3 ? words[1] : words[2];
        const float code = float(CODE_UNIT * (word >> shift_to(i == 0 ? before : i - 1) & CODE_MASK));
        sides |= (uint(code >= params.lower) | uint(code <= params.upper) << 8u) << i;
    }
    return sides | (sides >> 1u & 0x0f0fu);   // for the four pairs of neighbours
}

void main()
{
    const uvec3 cell = params.cell_begin + gl_GlobalInvocationID;
    if (any(greaterThanEqual(cell, params.cell_end))) return;
    // The samples between the centres of these voxels and of the preceding voxels lie in up to eight cells, and a
    // sample assigned to a neighbouring voxel may lie in any of the surrounding cells.
    const bool is_empty = imageLoad(leap, ivec3(cell)).x >> LEAP_DISTANCE_SHIFT > 1u;
    bool is_painted = false;
    [[unroll]] for (uint i = 0u; i < 8u && !is_empty; ++i) {
        const uvec3 before = uvec3(i & 1u, i >> 1u & 1u, i >> 2u);
        is_painted = is_painted || (imageLoad(leap, ivec3(cell - min(cell, before))).x & LEAP_PAINTED) != 0u;
    }
    uvec2 bits = uvec2(is_painted ? ALL : 0u);
    if (!is_empty && !is_painted) {
        const ivec3 first = place_of_first() + ivec3(CELL_SIZE * cell) - ivec3(0, 1, 1);
        uint plane_before[4];   // four rows of bits, each covering two rows of voxels
        [[unroll]] for (int z = 0; z < 5; ++z) {
            uint plane[4];
            uint row_before = 0u;
            [[unroll]] for (int y = 0; y < 5; ++y) {
                const uint row = sides_of_row(first.x, first.y + y, first.z + z);
                if (y > 0) plane[y - 1] = row | row_before;
                row_before = row;
            }
            if (z > 0) {
                uint seen = 0u;
                [[unroll]] for (uint y = 0u; y < 4u; ++y) {
                    const uint sides = plane[y] | plane_before[y];
                    seen |= (sides & sides >> 8u & 0xfu) << 4u * y;
                }
                bits[(z - 1) >> 1] |= seen << 16u * uint((z - 1) & 1);
            }
            plane_before = plane;
        }
    }
    imageStore(sample_bits, ivec3(cell.xy, 2u * cell.z), uvec4(bits.x));
    imageStore(sample_bits, ivec3(cell.xy, 2u * cell.z + 1u), uvec4(bits.y));
}
