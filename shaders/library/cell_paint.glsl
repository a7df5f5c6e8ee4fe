// Paint in a cell of the leap grid. Needs `mask` and `visible_groups`.

struct CellPaint {
    bool is_there;  // a voxel is in a group
    bool shows;     // a voxel is in a visible group
};

CellPaint paint_in(uint mask_slot, uvec3 cell_of_brick)
{
    const uvec3 base = mask_slot_origin(mask_slot) + CELL_SIZE * cell_of_brick;
    uint groups = 0u, shown = 0u;
    for (uint i = 0u; i < CELL_SIZE * CELL_SIZE * CELL_SIZE; ++i) {
        const uvec3 voxel = base + uvec3(i % CELL_SIZE, (i / CELL_SIZE) % CELL_SIZE, i / (CELL_SIZE * CELL_SIZE));
        const uint group = imageLoad(mask, ivec3(voxel)).x;
        groups |= group;
        shown |= visible_groups.bits[group >> 5] >> (group & 31u) & 1u;
    }
    return CellPaint(groups != 0u, shown != 0u);
}
