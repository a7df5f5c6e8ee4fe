// One workgroup per brick: finds which of the brick's cells may be visible, how far away the nearest visible cell is,
// and which cells are painted (pages.h).
// MASKED: a cell is also occupied if one of its voxels is in a visible group.
// variants: MASKED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "../pages.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { BrickLeapParams params; };
layout(binding = 0, r32ui) uniform readonly uimage3D cell_ranges;   // per slot: minimum | maximum << 16
layout(binding = 1, scalar) readonly buffer Jobs { BrickLeapJob list[]; } jobs;
layout(binding = 2, scalar) readonly buffer VisibleIntervals { uint before[]; } visible_intervals;
layout(binding = 3, r8ui) uniform writeonly uimage3D cell_leap;
#ifdef MASKED
layout(binding = 4, r8ui) uniform readonly uimage3D mask;
layout(binding = 5, scalar) readonly buffer VisibleGroups { uint bits[]; } visible_groups;
#define MASK_TABLE_BINDING 6
#define MASK_TABLE_HASHED
#include "../library/mask.glsl"
#endif

#include "../library/occupancy.glsl"

shared uint distances[2][BRICK_CELLS * BRICK_CELLS * BRICK_CELLS];

#ifdef MASKED
#include "../library/cell_paint.glsl"

CellPaint paint_of(const BrickLeapJob job, uvec3 cell)
{
    if (job.mask_slot == 0u) return CellPaint(false, false);
    // A coarse cell has too many voxels to examine, so it counts as painted if any voxel of its brick is painted.
    if (job.level > 0u) return CellPaint(true, true);
    if (params.paint_reach > 0u) return paint_around(BRICK_CELLS * job.brick + cell, uvec3(0xffffffffu));
    return paint_in(job.mask_slot, cell);
}
#endif

// One axis of the Chebyshev distance. Cells outside the brick are ignored.
uint nearer(uint source, uint at, uint stride, uint position)
{
    uint best = distances[source][at];
    for (uint k = 1u; k < BRICK_CELLS && k < best; ++k) {
        const uint below = k <= position ? distances[source][at - k * stride] : best;
        const uint above = position + k < BRICK_CELLS ? distances[source][at + k * stride] : best;
        best = min(best, max(k, min(below, above)));
    }
    return best;
}

void main()
{
    const BrickLeapJob job = jobs.list[gl_WorkGroupID.x];
    const uvec2 column = gl_LocalInvocationID.xy;
    const uvec3 origin = BRICK_CELLS * unpack_slot(job.slot);
    uint painted = 0u;   // bit per cell of the column
    for (uint z = 0u; z < BRICK_CELLS; ++z) {
        const uvec3 cell = uvec3(column, z);
        bool occupied = params.skipping == 0u ||
                        transfer_function_shows(imageLoad(cell_ranges, ivec3(origin + cell)).x);
#ifdef MASKED
        const CellPaint paint = paint_of(job, cell);
        occupied = occupied || paint.shows;
        painted |= uint(paint.is_there) << z;
#endif
        distances[0][grid_index(cell, uvec3(BRICK_CELLS))] = occupied ? 0u : BRICK_CELLS;
    }
    barrier();
    for (uint z = 0u; z < BRICK_CELLS; ++z) {
        const uint at = grid_index(uvec3(column, z), uvec3(BRICK_CELLS));
        distances[1][at] = nearer(0u, at, 1u, column.x);
    }
    barrier();
    for (uint z = 0u; z < BRICK_CELLS; ++z) {
        const uint at = grid_index(uvec3(column, z), uvec3(BRICK_CELLS));
        distances[0][at] = nearer(1u, at, BRICK_CELLS, column.y);
    }
    barrier();
    for (uint z = 0u; z < BRICK_CELLS; ++z) {
        const uint at = grid_index(uvec3(column, z), uvec3(BRICK_CELLS));
        const uint distance = nearer(0u, at, BRICK_CELLS * BRICK_CELLS, z);
        const uint is_painted = painted >> z & CELL_PAINTED;
        imageStore(cell_leap, ivec3(origin + uvec3(column, z)), uvec4(distance << CELL_DISTANCE_SHIFT | is_painted));
    }
}
