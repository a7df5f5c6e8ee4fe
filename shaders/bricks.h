// Bricks, atlas and page table: the address arithmetic that kernels and C++ share.
//
// A brick holds 32^3 voxels. Paged bricks are in slots of the atlas, a 3-D texture, with an apron of one voxel on each
// side, so that trilinear filtering, and central differences of +-0.5 voxel, never need a second brick. Bricks of a
// resident volume are contiguous, within a border of one voxel that repeats the outermost voxels. Along x there is no
// border: readers clamp to the row, so that rows keep the lengths that devices prefer. Slot 0 never holds a brick and
// means "not on the device".
#ifndef SHVR_BRICKS_H
#define SHVR_BRICKS_H
#include "shared.h"

SHARED_BEGIN

SHARED_CONST uint BRICK_SIZE = 32u;
SHARED_CONST uint BRICK_APRON = 1u;
SHARED_CONST uint BRICK_TEXELS = 34u;  // BRICK_SIZE + 2 * BRICK_APRON
SHARED_CONST uint CELL_SIZE = 4u;      // side of a cell of the leap grid, in voxels
SHARED_CONST uint BRICK_CELLS = 8u;    // BRICK_SIZE / CELL_SIZE
SHARED_CONST uint NO_SLOT = 0u;
SHARED_CONST uint MAX_ATLASES = 4u;  // maximum number of images in an atlas of paged bricks (library/atlas.glsl)

/// Linear index of a brick (or cell) in a grid of `counts`, x fastest.
SHARED_FUNCTION uint grid_index(uvec3 position, uvec3 counts)
{
    return position.x + counts.x * (position.y + counts.y * position.z);
}

/// Packs a slot's position in its atlas, in slots, into 8 bits per axis. Unpacking needs no division, and atlases,
/// including stacked ones, have up to 255 slots per side. Slot 0, at the origin, never holds a brick.
SHARED_FUNCTION uint pack_slot(uvec3 slot)
{
    return slot.x | slot.y << 8u | slot.z << 16u;
}

SHARED_FUNCTION uvec3 unpack_slot(uint packed_slot)
{
    return uvec3(packed_slot & 0xffu, packed_slot >> 8u & 0xffu, packed_slot >> 16u & 0xffu);
}

/// First texel of a slot, apron included, in an image with BRICK_TEXELS per slot side, such as ambient light values.
SHARED_FUNCTION uvec3 slot_origin(uint packed_slot)
{
    return BRICK_TEXELS * unpack_slot(packed_slot);
}

/// Size of an atlas slot along each axis, in codes of `code_bytes` bytes, aprons included. Rows of a slot are whole
/// words.
SHARED_FUNCTION uvec3 slot_codes(uint code_bytes)
{
    return uvec3(code_bytes == 1u ? 36u : BRICK_TEXELS, BRICK_TEXELS, BRICK_TEXELS);
}

/// Border around a volume of contiguous bricks, in codes on each side.
SHARED_FUNCTION uvec3 code_border()
{
    return uvec3(0u, 1u, 1u);
}

/// First voxel of a brick in the mask's atlas, whose bricks have no aprons.
SHARED_FUNCTION uvec3 mask_slot_origin(uint packed_slot)
{
    return BRICK_SIZE * unpack_slot(packed_slot);
}

/// Two hash values that give, modulo the table's size, the two places of a painted brick in a hashed table: a hash of
/// Teschner and others (2003), and a sum with other primes.
SHARED_FUNCTION uvec2 mask_places(uvec3 brick)
{
    const uvec2 hash = uvec2(brick.x * 73856093u ^ brick.y * 19349663u ^ brick.z * 83492791u,
                             brick.x * 2654435761u + brick.y * 2246822519u + brick.z * 3266489917u);
    return hash ^ hash >> 15u;
}
/// Uints per entry: x | y << 16, z, slot. Before the entries, the table holds the index of its last entry: a power of
/// two minus one.
SHARED_CONST uint MASK_ENTRY = 3u;

SHARED_END
#endif
