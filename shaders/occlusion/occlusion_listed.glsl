// Lists the voxels of a brick for which occlusion_bake.comp computes values: those next to a visible voxel. Needs that
// kernel's `params`, and the codes of voxels.

const uint CELLS_OF_ONE = BRICK_CELLS * BRICK_CELLS * BRICK_CELLS / OCCLUSION_SPLIT;
const uint VOXELS_OF_CELL = CELL_SIZE * CELL_SIZE * CELL_SIZE;
#ifdef PAGED
const uint APRON_VOXELS = BRICK_TEXELS * BRICK_TEXELS * BRICK_TEXELS - BRICK_SIZE * BRICK_SIZE * BRICK_SIZE;
const uint APRONS_OF_ONE = (APRON_VOXELS + OCCLUSION_SPLIT - 1u) / OCCLUSION_SPLIT;
#else
const uint APRONS_OF_ONE = 0u;
#endif
shared uint cells[CELLS_OF_ONE];
shared uint cell_count;
// Two voxels per entry: cell << 6 | voxel of the cell, or IN_APRON + the number of a voxel in the apron.
shared uint voxels[(CELLS_OF_ONE * VOXELS_OF_CELL + APRONS_OF_ONE + 1u) / 2u];
shared uint voxel_count;
const uint IN_APRON = 1u << 15u;

// Whether any of these voxels is in an occupied cell or, with `grow`, within one voxel of such a cell.
bool any_cell_is_occupied(const OcclusionJob job, ivec3 first_voxel, ivec3 last_voxel)
{
    const int grow = int(params.grow), side = 1 + 2 * grow;   // the same for all lanes, so that loops do not diverge
    const ivec3 first = first_voxel - grow >> 2, last = last_voxel + grow >> 2;
    bool found = false;
    for (int i = 0; i < side * side * side; ++i) {
        const ivec3 cell = min(first + ivec3(i % side, i / side % side, i / (side * side)), last);
        found = cell_is_occupied(params.reach, params.cell_counts, job, cell) || found;
    }
    return found;
}

ivec3 voxel_of(uint cell, uint lane)
{
    return 4 * ivec3(cell & 7u, cell >> 3u & 7u, cell >> 6u) + ivec3(lane & 3u, lane >> 2u & 3u, lane >> 4u);
}

#ifdef PAGED
// Enumerates the voxels directly around the brick: two whole layers, and the rings between these.
ivec3 apron_voxel(uint number)
{
    const uint side = BRICK_TEXELS, layer = side * side, ring = 4u * (side - 1u), inner = side - 2u;
    const bool is_in_layer = number < 2u * layer;
    const uint in_layer = number % layer, rest = number - 2u * layer, r = rest % ring;
    const uvec2 row = r < 2u * side ? uvec2(r % side, r < side ? 0u : side - 1u)
                                    : uvec2(r < 2u * side + inner ? 0u : side - 1u, (r - 2u * side) % inner + 1u);
    const uvec3 texel = is_in_layer ? uvec3(in_layer % side, in_layer / side, number < layer ? 0u : side - 1u)
                                    : uvec3(row, rest / ring + 1u);
    return ivec3(texel) - 1;
}
#endif

// The texel of a voxel's code, in the brick that contains the voxel; this brick is present and of this level.
ivec3 texel_of(const OcclusionJob job, ivec3 voxel)
{
#ifdef PAGED
    return place_in_slot(entry_at(params.reach, voxel >> 5)) + (voxel & 31);
#else
    return place_of_first() + ivec3(BRICK_SIZE * job.brick) + voxel;
#endif
}

// Returns a bit for each of four voxels in a row: whether visible samples may read the voxel's value because the
// transfer function shows something between its density and the densities around it. Paint and the like are ignored.
uint shows_nearby(ivec3 texel)
{
    vec4 lower = vec4(65535.0), upper = vec4(0.0);
    for (int i = 0; i < 9; ++i) {
        const ivec3 first = texel + ivec3(-1, i % 3 - 1, i / 3 - 1);
        const vec2 before = vec2(code_at(first), code_at(first + ivec3(1, 0, 0)));
        const vec2 middle = vec2(code_at(first + ivec3(2, 0, 0)), code_at(first + ivec3(3, 0, 0)));
        const vec2 behind = vec2(code_at(first + ivec3(4, 0, 0)), code_at(first + ivec3(5, 0, 0)));
        const vec4 a = vec4(before, middle), b = vec4(before.y, middle, behind.x), c = vec4(middle, behind);
        lower = min(lower, min(a, min(b, c)));
        upper = max(upper, max(a, max(b, c)));
    }
    uint bits = 0u;
    for (int i = 0; i < 4; ++i)
        bits |= uint(transfer_function_shows(uint(lower[i]) | uint(upper[i]) << 16u)) << i;
    return bits;
}

void add_voxel(uint voxel)
{
    const uint at = atomicAdd(voxel_count, 1u);
    atomicAdd(voxels[at >> 1u], voxel << 16u * (at & 1u));
}

// Lists the voxels to be computed, in no particular order.
void list_voxels(const OcclusionJob job)
{
    const uint lane = gl_LocalInvocationIndex;
    if (lane == 0u) {
        cell_count = 0u;
        voxel_count = 0u;
    }
    for (uint i = lane; i < uint(voxels.length()); i += 64u) voxels[i] = 0u;
    barrier();
    for (uint i = lane; i < CELLS_OF_ONE; i += 64u) {
        const uint cell = i * OCCLUSION_SPLIT + gl_WorkGroupID.z;
        const ivec3 first = voxel_of(cell, 0u);
        if (any_cell_is_occupied(job, first, first + 3)) cells[atomicAdd(cell_count, 1u)] = cell;
    }
    barrier();
    // Loop counts are the same for all lanes. One of the two loops is unused and has a count of 0.
    const uint found = cell_count, by_voxel = params.grow != 0u ? found : 0u;
    for (uint i = 0u; i < by_voxel; ++i) {
        const ivec3 voxel = voxel_of(cells[i], lane);
        if (any_cell_is_occupied(job, voxel, voxel)) add_voxel(cells[i] << 6u | lane);
    }
    const ivec3 first = texel_of(job, ivec3(0));
    const uint row = lane & 15u, by_rows = params.grow != 0u ? 0u : (found + 3u) / 4u;
    for (uint i = 0u; i < by_rows; ++i) {
        const uint index = 4u * i + (lane >> 4u), cell = cells[min(index, found - 1u)];
        const uint bits = shows_nearby(first + voxel_of(cell, 4u * row));
        for (uint k = 0u; k < 4u; ++k)
            if (index < found && (bits >> k & 1u) != 0u) add_voxel(cell << 6u | 4u * row + k);
    }
#ifdef PAGED
    // Excludes voxels of the apron that neighbouring bricks list as their own.
    for (uint i = OCCLUSION_SPLIT * lane + gl_WorkGroupID.z; i < APRON_VOXELS; i += 64u * OCCLUSION_SPLIT) {
        const ivec3 voxel = apron_voxel(i);
        const uint entry = entry_at(params.reach, voxel >> 5);
        const ivec3 first = voxel & ~3;
        const bool is_there = entry != 0u && entry >> OCCLUSION_LEVEL_SHIFT == 0u;
        if (!is_there || !any_cell_is_occupied(job, params.grow != 0u ? voxel : first,
                                               params.grow != 0u ? voxel : first + 3))
            continue;
        if (params.grow != 0u || (shows_nearby(texel_of(job, voxel)) & 1u) != 0u) add_voxel(IN_APRON + i);
    }
#endif
    barrier();
}
