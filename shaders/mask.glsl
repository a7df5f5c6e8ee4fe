// Finding painted bricks: 32^3 voxels without an apron. NO_SLOT means that nothing is painted there. Needs
// `mask_table`. A volume of a thousand bricks a side has no room for a table of all of them: MASK_TABLE_HASHED is one by
// open addressing (engine/scene/device_mask.cpp makes it).

#ifdef MASK_TABLE_HASHED
uint mask_slot_of(uvec3 brick, uvec3 brick_counts)
{
    const uint last = mask_table.slots[0], first = mask_hash(brick);
    uint found = 0u;
    for (uint probe = 0u; probe < MASK_PROBES; ++probe) {   // always all of them: lanes stay together
        const uint entry = 1u + MASK_ENTRY * (first + probe & last);
        const bool is_it = mask_table.slots[entry] == (brick.x | brick.y << 16u) && mask_table.slots[entry + 1u] == brick.z;
        found |= is_it ? mask_table.slots[entry + 2u] : 0u;
    }
    return found;
}
#else
uint mask_slot_of(uvec3 brick, uvec3 brick_counts)
{
    return mask_table.slots[grid_index(brick, brick_counts)];
}
#endif
