// Gathers the data that a brick's rays sample around it (occlusion.h): ramps of voxels, computed from densities and
// gradients, and copies of the cells of paged bricks. Cells of a resident volume are already contiguous.
// variants: PAGED FILTERED MASKED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "../pages.h"
#include "occlusion.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(binding = 0, scalar) readonly buffer Params { OcclusionGatherParams data; } params_block;
layout(binding = 1, scalar) readonly buffer Jobs { OcclusionJob list[]; } jobs;
layout(binding = 2, scalar) readonly buffer Opacities { OcclusionEntry entries[]; } opacities;   // over a tap's stretch
#ifdef FILTERED
layout(binding = 3) uniform sampler3D atlas;
#else
layout(binding = 3, r32ui) uniform readonly uimage3D atlas;
#endif
layout(binding = 4, scalar) readonly buffer Around { uint entries[]; } bricks_around;
#ifdef PAGED
layout(binding = 5, r8ui) uniform readonly uimage3D cell_leap;
#else
layout(binding = 5, r32ui) uniform readonly uimage3D leap;
#endif
layout(binding = 9, r32ui) uniform writeonly uimage3D near;
#ifdef PAGED
layout(binding = 10, r32ui) uniform readonly uimage3D cells_2;
layout(binding = 11, r32ui) uniform readonly uimage3D cells_4;
layout(binding = 12, r32ui) uniform writeonly uimage3D around_2;
layout(binding = 13, r32ui) uniform writeonly uimage3D around_4;
#endif

#include "occlusion_around.glsl"
#include "occlusion_opacity.glsl"
#ifdef PAGED
#define STACKED 20
#endif
#include "../library/voxel_code.glsl"
#include "occlusion_ramp.glsl"

const uint CELLS_A_SIDE = NEAR_SIDE / CELL_SIZE;
const uint CELLS_OF_ALL = CELLS_A_SIDE * CELLS_A_SIDE * CELLS_A_SIDE;
// `near` starts as 0, which is right where nothing is visible. Loop counts, instead of branches, skip work.
const uint CELLS_OF_ONE = (CELLS_OF_ALL + OCCLUSION_SPLIT - 1u) / OCCLUSION_SPLIT;
shared uint cells[CELLS_OF_ONE];
shared uint cell_count;

ivec3 place(uint i, uint side)
{
    return ivec3(i % side, i / side % side, i / (side * side));
}

// Converts a position relative to the job's brick into a position relative to the brick that contains it, in voxels of
// that brick's level.
ivec3 in_brick_of(const OcclusionJob job, ivec3 voxel, int above)
{
    return int(BRICK_SIZE) * ivec3(job.brick) + voxel >> above & int(BRICK_SIZE - 1u);
}

uint near_of(const OcclusionGatherParams params, const OcclusionJob job, ivec3 voxel)
{
    const uint entry = entry_at(params.reach, voxel >> 5), above = entry >> OCCLUSION_LEVEL_SHIFT;
#ifdef PAGED
    const ivec3 texel = place_in_slot(entry) + in_brick_of(job, voxel, int(above));
#else
    const ivec3 texel = place_of_first() + ivec3(BRICK_SIZE * job.brick) + voxel;
#endif
    const float side = float(1u << above);
    const float middle = code_at(texel);
    const vec3 before = vec3(code_at(texel - ivec3(1, 0, 0)), code_at(texel - ivec3(0, 1, 0)),
                             code_at(texel - ivec3(0, 0, 1)));
    const vec3 behind = vec3(code_at(texel + ivec3(1, 0, 0)), code_at(texel + ivec3(0, 1, 0)),
                             code_at(texel + ivec3(0, 0, 1)));
    const vec3 slope = (behind - before) / (2.0 * side);
    // A voxel of a coarse brick covers several voxels of this level; this is the offset from that voxel's centre.
    const vec3 beside = vec3(voxel & int((1u << above) - 1u)) + 0.5 - 0.5 * side;
    // Densities curve within a voxel: the voxel's mean density is the density at its centre plus `bend`.
    const float bend = dot(before + behind - 2.0 * middle, vec3(0.125 / side));
    const float code = middle + dot(slope, beside) + bend;
    // Limits the code to the range of the voxel and its neighbours: cells whose range shows nothing are never read.
    const vec3 least = min(before, behind), most = max(before, behind);
    const float lower = min(middle, min(least.x, min(least.y, least.z)));
    const float upper = max(middle, max(most.x, max(most.y, most.z)));
    const vec3 centre = float(1u << params.voxels.level) * (vec3(ivec3(BRICK_SIZE * job.brick) + voxel) + 0.5);
    const float held = entry != 0u ? opacity_held(params.voxels, centre) : 0.0;
    const uint ramp = ramp_of(params.voxels, clamp(code, lower, upper), slope, lower, upper,
                              STEEPEST_OF_VOXELS);
    return held < 0.0 ? ramp : held_ramp(held);
}

#ifdef PAGED
// The part of a coarser level's ramp that lies in one of the cells it covers, for the stretch of a tap of this
// level.
uint part_of_ramp(uint packed, ivec3 cell, int above, float exponent)
{
    const float share = 1.0 / float(1 << above);
    const vec3 offset = share * (vec3(cell & (1 << above) - 1) + 0.5) - 0.5, slope = vec3(ramp_slope(packed));
    const float height = float(ramp_height(packed)) + RAMP_HEIGHTS / RAMP_SLOPES * dot(slope, offset);
    const float top = float(packed & 255u), left = pow(max(1.0 - top * top / 65025.0, 0.0), exponent);
    const uint code = to_uint(255.0 * sqrt(1.0 - left) + 0.5);
    const uint bits = ramp_bits(code, int(round(clamp(height, -30.0, 30.0))), ivec3(round(share * slope)));
    return code == 0u ? 0u : bits;
}

// Converts the codes of a coarser level's cell to the stretch of this level's taps.
uint stretched(uint packed, float exponent)
{
    const uvec3 code = uvec3(packed, packed >> 8u, packed >> 16u) & 255u;
    const vec3 left = pow(max(1.0 - vec3(code * code) / 65025.0, 0.0), vec3(exponent));
    const uvec3 of_tap = to_uint(255.0 * sqrt(1.0 - left) + 0.5);
    return packed == 0u ? 0u : of_tap.x | of_tap.y << 8u | of_tap.z << 16u;
}

// Copies the cells of one size around the brick. `are_coarser`: copies only the cells for which a brick of a coarser
// level stands in; otherwise copies only the other cells.
void copy_cells(const OcclusionGatherParams params, const OcclusionJob job, uint size, bool are_coarser, uint end)
{
    const int shift = int(size) + 1, apron = int(params.aprons[size]);
    const uint side = (BRICK_SIZE >> shift) + 2u * params.aprons[size];
    const float inverse_side = 1.0 / float(side);
    const ivec3 behind = ivec3(side * scratch_place(gl_WorkGroupID.x));
    for (uint i = 64u * gl_WorkGroupID.z + gl_LocalInvocationIndex; i < min(side * side * side, end);
         i += 64u * OCCLUSION_SPLIT) {
        // Float arithmetic is exact for numbers this small, and faster than integer division.
        const uint row = to_uint((float(i) + 0.5) * inverse_side), z = to_uint((float(row) + 0.5) * inverse_side);
        const ivec3 texel = ivec3(i - side * row, row - side * z, z), voxel = texel - apron << shift;
        const uint entry = entry_at(params.reach, voxel >> 5);
        const int above = int(entry >> OCCLUSION_LEVEL_SHIFT);
        if (are_coarser != above > 0) continue;
        const ivec3 from = int(BRICK_SIZE >> shift) * ivec3(unpack_slot(entry)) +
                           (in_brick_of(job, voxel, above) >> shift);
        uint packed = size == 0u ? imageLoad(cells_2, from).x : imageLoad(cells_4, from).x;
        if (are_coarser && size == 0u)
            packed = part_of_ramp(packed, int(BRICK_SIZE) * ivec3(job.brick) + voxel >> 1, above,
                                  params.exponents[above]);
        if (are_coarser && size == 1u) packed = stretched(packed, params.exponents[OCCLUSION_LEVELS + above]);
        if (size == 0u)
            imageStore(around_2, texel + behind, uvec4(packed));
        else
            imageStore(around_4, texel + behind, uvec4(packed));
    }
}
#endif

void main()
{
    const OcclusionGatherParams params = params_block.data;
    const OcclusionJob job = jobs.list[gl_WorkGroupID.x];
    const uint lane = gl_LocalInvocationIndex, share = gl_WorkGroupID.z;
    load_around(job, params.reach);
    if (lane == 0u) cell_count = 0u;
    barrier();
    for (uint i = lane; i < CELLS_OF_ONE; i += 64u) {
        const uint cell = i * OCCLUSION_SPLIT + share;
        if (cell >= CELLS_OF_ALL) continue;
        const ivec3 at = place(cell, CELLS_A_SIDE) - int(NEAR_APRON / CELL_SIZE);
        if (cell_is_occupied(params.reach, params.cell_counts, job, at)) cells[atomicAdd(cell_count, 1u)] = cell;
    }
    barrier();
    const ivec3 in_cell = place(lane, CELL_SIZE);
    const ivec3 behind = ivec3(scratch_place(gl_WorkGroupID.x));
    const uint end = cell_count;
    for (uint i = 0u; i < end; ++i) {
        const ivec3 texel = int(CELL_SIZE) * place(cells[i], CELLS_A_SIDE) + in_cell;
        const uint packed = near_of(params, job, texel - int(NEAR_APRON));
        imageStore(near, texel + int(NEAR_SIDE) * behind, uvec4(packed));
    }
#ifdef PAGED
    bool is_any_coarser = false;
    for (uint i = 0u; i < OCCLUSION_AROUND; ++i)
        is_any_coarser = is_any_coarser || (i < around_count(params.reach) && around[i] >> OCCLUSION_LEVEL_SHIFT > 0u);
    // Loops with a count of 0 skip rare work without a branch.
    const uint end_of_coarser = is_any_coarser ? ~0u : 0u;
    copy_cells(params, job, 0u, false, ~0u);
    copy_cells(params, job, 1u, false, ~0u);
    copy_cells(params, job, 0u, true, end_of_coarser);
    copy_cells(params, job, 1u, true, end_of_coarser);
#endif
}
