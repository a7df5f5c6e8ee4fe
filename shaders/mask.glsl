// Finding painted bricks: 32^3 voxels without an apron. Slots are 1 or more; 0 means that nothing is painted there. Needs
// `mask_table`. A volume of a thousand bricks a side has no room for a table of all of them: MASK_TABLE_HASHED is one by
// open addressing (engine/scene/device_mask.cpp makes it).

#ifdef MASK_TABLE_HASHED
uint mask_slot_of(uvec3 brick, uvec3 brick_counts)
{
    const uint last = mask_table.slots[0];
    uint at = mask_hash(brick) & last;
    for (;;) {
        const uint entry = 1u + MASK_ENTRY * at;
        const uint slot = mask_table.slots[entry + 2u];
        if (slot == 0u || (mask_table.slots[entry] == (brick.x | brick.y << 16u) && mask_table.slots[entry + 1u] == brick.z))
            return slot;
        at = at + 1u & last;
    }
}
#else
uint mask_slot_of(uvec3 brick, uvec3 brick_counts)
{
    return mask_table.slots[grid_index(brick, brick_counts)];
}
#endif
