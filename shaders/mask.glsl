// Addressing of mask bricks: 32^3 voxels without an apron. `slot` comes from the mask table and is 1 or more.

uvec3 mask_origin(uint slot, uvec3 slots)
{
    const uint s = slot - 1u;
    return BRICK_SIZE * uvec3(s % slots.x, (s / slots.x) % slots.y, s / (slots.x * slots.y));
}
