// Finds the group at a position. Needs mask.glsl and `mask`.

uint group_of(uvec3 voxel)
{
    const uint slot = mask_slot_of(voxel / BRICK_SIZE);
    return slot == 0u ? 0u : imageLoad(mask, ivec3(mask_slot_origin(slot) + voxel % BRICK_SIZE)).x;
}

// The label with the largest weight among the eight voxels around the position. Weights are trilinear, and weights of
// equal labels add up. Labels are never interpolated, so no new label appears; at a voxel's centre, the voxel's own
// label has all the weight. Beyond the last voxels (`last`), their labels continue. Ties go to the voxel that is first
// in order of x, y, z.
uint group_around(vec3 position, ivec3 last)
{
    const vec3 lattice = position - 0.5;
    const vec3 corner = floor(lattice), upper = lattice - corner;
    uint groups[8];
    float weights[8];
    [[unroll]] for (uint i = 0u; i < 8u; ++i) {
        const uvec3 offset = uvec3(i, i >> 1u, i >> 2u) & 1u;
        const vec3 along = mix(1.0 - upper, upper, vec3(offset));
        groups[i] = group_of(uvec3(clamp(ivec3(corner) + ivec3(offset), ivec3(0), last)));
        weights[i] = along.x * along.y * along.z;
    }
    uint heaviest = 0u;
    float most = 0.0;
    [[unroll]] for (uint i = 0u; i < 8u; ++i) {
        float sum = 0.0;
        [[unroll]] for (uint k = 0u; k < 8u; ++k) sum += groups[k] == groups[i] ? weights[k] : 0.0;
        heaviest = sum > most ? groups[i] : heaviest;
        most = max(most, sum);
    }
    return heaviest;
}
