// Paint in a cell of the leap grid. Needs mask.glsl, `mask` and `visible_groups`.

struct CellPaint {
    bool is_there;  // a voxel is in a group
    bool shows;     // a voxel is in a visible group
};

void add_paint(uvec3 in_mask, inout uint groups, inout uint shown)
{
    const uint group = imageLoad(mask, ivec3(in_mask)).x;
    groups |= group;
    shown |= visible_groups.bits[group >> 5] >> (group & 31u) & 1u;
}

CellPaint paint_in(uint mask_slot, uvec3 cell_of_brick)
{
    const uvec3 base = mask_slot_origin(mask_slot) + CELL_SIZE * cell_of_brick;
    uint groups = 0u, shown = 0u;
    for (uint i = 0u; i < CELL_SIZE * CELL_SIZE * CELL_SIZE; ++i) {
        const uvec3 voxel = base + uvec3(i % CELL_SIZE, (i / CELL_SIZE) % CELL_SIZE, i / (CELL_SIZE * CELL_SIZE));
        add_paint(voxel, groups, shown);
    }
    return CellPaint(groups != 0u, shown != 0u);
}

// The paint of a cell's voxels and of the voxels next to them, which may be in other bricks. `brick_counts`: size of
// the volume in bricks.
CellPaint paint_around(uvec3 cell, uvec3 brick_counts)
{
    const uint side = CELL_SIZE + 2u;
    uint groups = 0u, shown = 0u;
    for (uint i = 0u; i < side * side * side; ++i) {
        const ivec3 voxel = ivec3(CELL_SIZE * cell) - 1 + ivec3(i % side, (i / side) % side, i / (side * side));
        const uvec3 brick = uvec3(max(voxel, 0)) / BRICK_SIZE;
        const bool is_inside = all(greaterThanEqual(voxel, ivec3(0))) && all(lessThan(brick, brick_counts));
        const uint slot = is_inside ? mask_slot_of(brick) : 0u;
        if (slot != 0u) add_paint(mask_slot_origin(slot) + uvec3(voxel) % BRICK_SIZE, groups, shown);
    }
    return CellPaint(groups != 0u, shown != 0u);
}
