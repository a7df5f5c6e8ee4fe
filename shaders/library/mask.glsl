// Finds painted bricks: 32^3 voxels without an apron. NO_SLOT means that nothing is painted there. The table is bound
// at MASK_TABLE_BINDING. A volume of a thousand bricks a side has no room for a table of all bricks, so
// MASK_TABLE_HASHED selects a hash table with open addressing (built by engine/device/device_mask.cpp).

#ifdef MASK_TABLE_HASHED
layout(binding = MASK_TABLE_BINDING, scalar) readonly buffer MaskTable { uint slots[]; } mask_table;

uint mask_slot_of(uvec3 brick)
{
    const uint last = mask_table.slots[0], first = mask_hash(brick);
    uint found = 0u;
    // always all of them, so that lanes stay together
    [[unroll]] for (uint probe = 0u; probe < MASK_PROBES; ++probe) {
        const uint entry = 1u + MASK_ENTRY * (first + probe & last);
        const bool is_it = mask_table.slots[entry] == (brick.x | brick.y << 16u) &&
                           mask_table.slots[entry + 1u] == brick.z;
        found |= is_it ? mask_table.slots[entry + 2u] : 0u;
    }
    return found;
}
#else
// An image, because every sample reads it, and lavapipe reads buffers one lane after another.
layout(binding = MASK_TABLE_BINDING, r32ui) uniform readonly uimage3D mask_table;

uint mask_slot_of(uvec3 brick)
{
    return imageLoad(mask_table, ivec3(brick)).x;
}
#endif
