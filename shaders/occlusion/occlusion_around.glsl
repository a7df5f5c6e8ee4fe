// Looks up the bricks around a brick whose values are computed, and which of these bricks' cells may be visible. Needs
// `bricks_around` and, if PAGED, `cell_leap`, otherwise `leap`.

#ifdef PAGED
const uint NEAR_APRON = OCCLUSION_NEAR_APRON_PAGED, NEAR_SIDE = OCCLUSION_NEAR_SIDE_PAGED;
#else
const uint NEAR_APRON = OCCLUSION_NEAR_APRON, NEAR_SIDE = OCCLUSION_NEAR_SIDE;
#endif

shared uint around[OCCLUSION_AROUND];

uint around_count(uint reach)
{
    const uint side = 2u * reach + 1u;
    return side * side * side;
}

void load_around(const OcclusionJob job, uint reach)
{
    for (uint i = gl_LocalInvocationIndex; i < around_count(reach); i += 64u)
        around[i] = bricks_around.entries[job.around + i];
}

uint entry_at(uint reach, ivec3 brick_offset)
{
    return around[grid_index(uvec3(brick_offset + int(reach)), uvec3(2u * reach + 1u))];
}

// `cell`: position in cells of the brick; positions outside the brick are in its neighbours.
bool cell_is_occupied(uint reach, uvec3 cell_counts, const OcclusionJob job, ivec3 cell)
{
#ifdef PAGED
    const uint entry = entry_at(reach, cell >> 3);
    const ivec3 in_brick = int(BRICK_CELLS) * ivec3(job.brick) + cell >> int(entry >> OCCLUSION_LEVEL_SHIFT) & 7;
    const uint found = imageLoad(cell_leap, ivec3(BRICK_CELLS * unpack_slot(entry)) + in_brick).x;
    return entry != 0u && found >> CELL_DISTANCE_SHIFT == 0u;
#else
    const ivec3 at = int(BRICK_CELLS) * ivec3(job.brick) + cell;
    if (any(lessThan(at, ivec3(0))) || any(greaterThanEqual(at, ivec3(cell_counts)))) return false;
    return imageLoad(leap, at).x >> LEAP_DISTANCE_SHIFT == 0u;
#endif
}
