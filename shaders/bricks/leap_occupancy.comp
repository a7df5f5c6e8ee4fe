// Sets the distance of cells to 0 if anything in the cell is visible, else to `empty_distance`. One word of cells per
// thread, which later stages read.
// MASKED: a cell is also occupied if a voxel in or next to the cell is in a visible group; also records whether it is
// painted.
// PATCH: writes entries of the grid, one per thread.
// variants: MASKED PATCH
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "../leap.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { OccupancyParams params; };
layout(binding = 0, r32ui) uniform readonly uimage3D cell_ranges;   // minimum | maximum << 16
layout(binding = 1, scalar) readonly buffer VisibleIntervals { uint before[]; } visible_intervals;
#ifdef PATCH
layout(binding = 2, r32ui) uniform writeonly uimage3D leap;
layout(binding = 3, scalar) readonly buffer PageTable { uint slots[]; } page_table;
#else
layout(binding = 2, r32ui) uniform writeonly uimage3D leap;
#endif
#ifdef MASKED
layout(binding = 4, r8ui) uniform readonly uimage3D mask;
#define MASK_TABLE_BINDING 5
layout(binding = 6, scalar) readonly buffer VisibleGroups { uint bits[]; } visible_groups;

#include "../library/mask.glsl"
#endif
#include "../library/occupancy.glsl"

#ifdef MASKED
#include "../library/cell_paint.glsl"
#endif

bool is_occupied(uvec3 cell, out bool painted)
{
    bool occupied = params.skipping == 0u || transfer_function_shows(imageLoad(cell_ranges, ivec3(cell)).x);
    painted = false;
#ifdef MASKED
    const uint mask_slot = mask_slot_of(cell / BRICK_CELLS);
    if (params.paint_reach > 0u) {
        const CellPaint paint = paint_around(cell, params.brick_counts);
        occupied = occupied || paint.shows;
        painted = paint.is_there;
    } else if (mask_slot != 0u) {
        const CellPaint paint = paint_in(mask_slot, cell % BRICK_CELLS);
        occupied = occupied || paint.shows;
        painted = paint.is_there;
    }
#endif
    return occupied;
}

void main()
{
    bool painted;
#ifdef PATCH
    const uvec3 cell = params.cell_begin + gl_GlobalInvocationID;
    if (any(greaterThanEqual(cell, params.cell_end))) return;
    const uint distance = is_occupied(cell, painted) ? 0u : params.empty_distance;
    const uint slot = page_table.slots[grid_index(cell / BRICK_CELLS, params.brick_counts)];
    imageStore(leap, ivec3(cell), uvec4(distance << LEAP_DISTANCE_SHIFT | (painted ? LEAP_PAINTED : 0u) | slot));
#else
    const uvec3 first = params.cell_begin + gl_GlobalInvocationID * uvec3(LEAP_WORD_CELLS, 1u, 1u);
    if (any(greaterThanEqual(first, params.cell_end))) return;
    uint word = 0u;
    for (uint i = 0u; i < LEAP_WORD_CELLS; ++i) {
        const uint distance = is_occupied(first + uvec3(i, 0u, 0u), painted) ? 0u : params.empty_distance;
        word |= (distance << LEAP_BYTE_SHIFT | (painted ? LEAP_BYTE_PAINTED : 0u)) << 8u * i;
    }
    imageStore(leap, ivec3(first.x / LEAP_WORD_CELLS, first.yz), uvec4(word));
#endif
}
