// Finds bricks in the directory of pages.h. Needs KEPT; declares its own bindings.
#include "to_int.glsl"

layout(binding = 1, scalar) readonly buffer Directory { uint entries[]; } directory;
layout(binding = 8, r8ui) uniform readonly uimage3D cell_leap;
layout(binding = 9, scalar) buffer Reached { uint bits[]; } reached;

// The region that contains a position: a brick, or a region with nothing visible (distance > 0).
struct Place {
    uint distance;    // in cells
    uint cell_shift;  // log2 of a cell's side, in voxels
    uint box_shift;   // leaps stay in the cube of 2^box_shift voxels around the position; 31: no limit
    uint slot;
    uint level;
    uint entry;
    bool is_painted;  // true: it may be painted
    bool is_missing;  // a ray that arrives here waits
};

// Finds the brick at a position, but not the cell, so samples anywhere in the brick may be visible and painted.
Place brick_at(const RaycastParams params, vec3 position)
{
    const uvec3 voxel = to_uint(position);
    Place place;
    place.cell_shift = params.page_shift;
    place.entry = grid_index(voxel >> place.cell_shift, params.page_counts);
    uint entry = directory.entries[place.entry];
    // The finest view of the largest volume descends ten levels; most pictures descend none. All lanes descend
    // together, because some devices lose values that a lane sets in a loop after other lanes have left it.
    for (uint depth = 0u; depth < params.page_depth; ++depth) {
        const bool down = entry >> PAGE_LEVEL_SHIFT == PAGE_NODE;
        place.cell_shift -= uint(down);
        const uvec3 half_of = voxel >> place.cell_shift & 1u;
        const uint child = (entry & PAGE_PAYLOAD_MASK) + half_of.x + 2u * half_of.y + 4u * half_of.z;
        place.entry = down ? child : place.entry;
        entry = directory.entries[place.entry];
    }
    place.distance = entry >> PAGE_DISTANCE_SHIFT;
    place.box_shift = 31u;
    place.is_painted = true;
    place.slot = entry & PAGE_PAYLOAD_MASK;
    place.level = entry >> PAGE_LEVEL_SHIFT & 0xfu;
    place.is_missing = KEPT == KEPT_ALL && place.distance == 0u && place.level == PAGE_MISSING;
    return place;
}

Place place_at(const RaycastParams params, vec3 position)
{
    Place place = brick_at(params, position);
    if (place.distance == 0u) {
        const uvec3 cell = to_uint(position) >> place.level + 2u & BRICK_CELLS - 1u;
        place.box_shift = place.cell_shift;
        place.cell_shift = place.level + 2u;
        const uint found = imageLoad(cell_leap, ivec3(BRICK_CELLS * unpack_slot(place.slot) + cell)).x;
        place.distance = place.is_missing ? 0u : found >> CELL_DISTANCE_SHIFT;
        place.is_painted = (found & CELL_PAINTED) != 0u;
    }
    return place;
}

// Tells the host that a ray visited this place; visits determine which bricks are loaded. Only the first visit is
// written; later rays just read, because writes to one word are serialized.
void note_reached(const Place place)
{
    const uint bit = 1u << (place.entry & 31u);
    if ((reached.bits[place.entry >> 5] & bit) == 0u) atomicOr(reached.bits[place.entry >> 5], bit);
}
