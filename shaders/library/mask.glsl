// Finds painted bricks: 32^3 voxels without an apron. NO_SLOT: nothing is painted in a brick. The table is bound at
// MASK_TABLE_BINDING. A table of all bricks would be too large for a volume of a thousand bricks a side, so
// MASK_TABLE_HASHED selects a hash table with each brick at one of two places (engine/bricks/painted_table.h).

#ifdef MASK_TABLE_HASHED
layout(binding = MASK_TABLE_BINDING, scalar) readonly buffer MaskTable { uint slots[]; } mask_table;

uint mask_slot_at(uvec3 brick, uint place)
{
    const uint entry = 1u + MASK_ENTRY * (place & mask_table.slots[0]);
    const bool is_it =
        mask_table.slots[entry] == (brick.x | brick.y << 16u) && mask_table.slots[entry + 1u] == brick.z;
    return is_it ? mask_table.slots[entry + 2u] : NO_SLOT;
}

uint mask_slot_of(uvec3 brick)
{
    const uvec2 places = mask_places(brick);
    return mask_slot_at(brick, places.x) | mask_slot_at(brick, places.y);
}
#else
// The table is an image and not a buffer: every sample reads it, and lavapipe reads buffers one lane at a time.
layout(binding = MASK_TABLE_BINDING, r32ui) uniform readonly uimage3D mask_table;

uint mask_slot_of(uvec3 brick)
{
    return imageLoad(mask_table, ivec3(brick)).x;
}
#endif
