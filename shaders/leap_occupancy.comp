// One cell per thread: is anything in it visible? Distance 0 where it is, LEAP_LIMIT where it is not.
// MASKED: a cell is occupied, too, where a voxel of a visible group is.
// variants: MASKED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "leap.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { OccupancyParams params; };
layout(binding = 0, r32ui) uniform readonly uimage3D cell_ranges;   // minimum | maximum << 16
layout(binding = 1, scalar) readonly buffer PageTable { uint slots[]; } page_table;
layout(binding = 2, scalar) readonly buffer VisibleIntervals { uint before[]; } visible_intervals;
layout(binding = 3, r32ui) uniform writeonly uimage3D leap;
#ifdef MASKED
layout(binding = 4, r8ui) uniform readonly uimage3D mask;
layout(binding = 5, scalar) readonly buffer MaskTable { uint slots[]; } mask_table;
layout(binding = 6, scalar) readonly buffer VisibleGroups { uint bits[]; } visible_groups;

#include "mask.glsl"
#endif
#include "occupancy.glsl"

#ifdef MASKED
bool paint_shows(uvec3 cell, uint mask_slot)
{
    const uvec3 base = mask_slot_origin(mask_slot, params.mask_slots) + CELL_SIZE * (cell % BRICK_CELLS);
    uint seen = 0u;
    for (uint i = 0u; i < CELL_SIZE * CELL_SIZE * CELL_SIZE; ++i) {
        const uvec3 voxel = base + uvec3(i % CELL_SIZE, (i / CELL_SIZE) % CELL_SIZE, i / (CELL_SIZE * CELL_SIZE));
        const uint group = imageLoad(mask, ivec3(voxel)).x;
        seen |= visible_groups.bits[group >> 5] >> (group & 31u) & 1u;
    }
    return seen != 0u;
}
#endif

void main()
{
    const uvec3 cell = params.cell_begin + gl_GlobalInvocationID;
    if (any(greaterThanEqual(cell, params.cell_end))) return;
    const uint brick = grid_index(cell / BRICK_CELLS, params.brick_counts);
    bool occupied = params.skipping == 0u || transfer_function_shows(imageLoad(cell_ranges, ivec3(cell)).x);
#ifdef MASKED
    const uint mask_slot = mask_slot_of(cell / BRICK_CELLS, params.brick_counts);
    if (!occupied && mask_slot != 0u) occupied = paint_shows(cell, mask_slot);
#endif
    imageStore(leap, ivec3(cell), uvec4((occupied ? 0u : LEAP_LIMIT << LEAP_DISTANCE_SHIFT) | page_table.slots[brick]));
}
