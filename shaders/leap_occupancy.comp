// One cell per thread: is anything in it visible? Distance 0 where it is, LEAP_LIMIT where it is not.
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

#include "occupancy.glsl"

void main()
{
    const uvec3 cell = params.cell_begin + gl_GlobalInvocationID;
    if (any(greaterThanEqual(cell, params.cell_end))) return;
    const uint brick = grid_index(cell / BRICK_CELLS, params.brick_counts);
    const bool occupied = params.skipping == 0u || transfer_function_shows(imageLoad(cell_ranges, ivec3(cell)).x);
    imageStore(leap, ivec3(cell), uvec4((occupied ? 0u : LEAP_LIMIT << LEAP_DISTANCE_SHIFT) | page_table.slots[brick]));
}
