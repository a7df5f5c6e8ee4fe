// One cell per thread: sets the cell's distance to 0 if anything in the cell is visible, else to `empty_distance`.
// Writes the byte that later stages read.
// MASKED: a cell is also occupied if a voxel in or next to the cell is in a visible group; also records whether it is
// painted.
// PATCH: writes entries of the grid.
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
layout(binding = 2, r8ui) uniform writeonly uimage3D leap;
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

void main()
{
    const uvec3 cell = params.cell_begin + gl_GlobalInvocationID;
    if (any(greaterThanEqual(cell, params.cell_end))) return;
    bool occupied = params.skipping == 0u || transfer_function_shows(imageLoad(cell_ranges, ivec3(cell)).x);
    bool painted = false;
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
    const uint distance = occupied ? 0u : params.empty_distance;
#ifdef PATCH
    const uint slot = page_table.slots[grid_index(cell / BRICK_CELLS, params.brick_counts)];
    imageStore(leap, ivec3(cell), uvec4(distance << LEAP_DISTANCE_SHIFT | (painted ? LEAP_PAINTED : 0u) | slot));
#else
    imageStore(leap, ivec3(cell), uvec4(distance << LEAP_BYTE_SHIFT | (painted ? LEAP_BYTE_PAINTED : 0u)));
#endif
}
