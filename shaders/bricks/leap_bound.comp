// Updates a leap grid after cells have changed: limits the leaps of the surrounding cells to the nearest changed cell,
// as if all changed cells were occupied. Leaps may become shorter than necessary, but never too long.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../leap.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { LeapBoundParams params; };
layout(binding = 0, r32ui) uniform uimage3D leap;

void main()
{
    const ivec3 cell = ivec3(params.cell_begin + gl_GlobalInvocationID);
    if (any(greaterThanEqual(cell, ivec3(params.cell_end)))) return;
    const ivec3 apart = max(ivec3(params.changed_begin) - cell, cell - ivec3(params.changed_end) + 1);
    const int to_changed = max(max(apart.x, apart.y), max(apart.z, 0));
    const uint before = imageLoad(leap, cell).x;
    const uint distance = min(before >> LEAP_DISTANCE_SHIFT, uint(to_changed));
    imageStore(leap, cell, uvec4(distance << LEAP_DISTANCE_SHIFT | before & (LEAP_PAINTED | LEAP_SLOT_MASK)));
}
