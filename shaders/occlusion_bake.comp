// How much light reaches every voxel of a brick that may be seen (occlusion.h): the mean over rays of the share of the radius
// that light comes along. Value of a ray = (1 / radius) sum over stretches of length * light that is left in the middle of it.
// Only voxels in occupied cells are made: the ranges of cells overlap by a voxel, so a sample that shows anything reads no
// others. PAGED: cells are those of bricks that come and go.
// variants: PAGED FILTERED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "leap.h"
#include "occlusion.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(binding = 0, scalar) readonly buffer Params { OcclusionParams data; } params_block;
layout(binding = 1, scalar) readonly buffer Jobs { OcclusionJob list[]; } jobs;
layout(binding = 2, scalar) readonly buffer Around { uint entries[]; } bricks_around;
#ifdef FILTERED
layout(binding = 3) uniform sampler3D atlas;
#else
layout(binding = 3, r32ui) uniform readonly uimage3D atlas;
#endif
layout(binding = 4, r8ui) uniform readonly uimage3D cells_1;
layout(binding = 5, r8ui) uniform readonly uimage3D cells_2;
layout(binding = 6, r8ui) uniform readonly uimage3D cells_4;
layout(binding = 7, r8ui) uniform writeonly uimage3D values;
layout(binding = 8, scalar) readonly buffer Directions { vec4 list[]; } directions;
layout(binding = 9, scalar) readonly buffer Taps { OcclusionTap list[]; } taps;
// What a tap's stretch leaves of the light, by the code it meets: made in double, and no power in the innermost loop.
layout(binding = 10, scalar) readonly buffer Passed { float by_code[]; } passed;
#ifdef PAGED
layout(binding = 11, r8ui) uniform readonly uimage3D cell_leap;
#else
layout(binding = 11, r32ui) uniform readonly uimage3D leap;
#endif

#include "voxel_code.glsl"

shared uint around[OCCLUSION_AROUND];
shared uint blocks[64];
shared uint block_count;

uint entry_at(uint reach, ivec3 brick_offset)
{
    const uint side = 2u * reach + 1u;
    return around[grid_index(uvec3(brick_offset + int(reach)), uvec3(side))];
}

// In cells of the brick; those of its neighbours lie beside.
bool cell_is_occupied(const OcclusionParams params, const OcclusionJob job, ivec3 cell)
{
#ifdef PAGED
    const uint entry = entry_at(params.reach, cell >> 3);
    const ivec3 in_brick = int(BRICK_CELLS) * ivec3(job.brick) + cell >> int(entry >> OCCLUSION_LEVEL_SHIFT) & 7;
    return entry != 0u && imageLoad(cell_leap, ivec3(BRICK_CELLS * unpack_slot(entry)) + in_brick).x == 0u;
#else
    const ivec3 at = int(BRICK_CELLS) * ivec3(job.brick) + cell;
    if (any(lessThan(at, ivec3(0))) || any(greaterThanEqual(at, ivec3(params.cell_counts)))) return false;
    return imageLoad(leap, at).x >> LEAP_DISTANCE_SHIFT == 0u;
#endif
}

// `cells`: how many a side hold the voxels, as long as `grow` is 0.
bool any_cell_is_occupied(const OcclusionParams params, const OcclusionJob job, ivec3 first_voxel, int cells)
{
    const int grow = int(params.grow), side = cells + grow * cells;   // the same for all lanes: they stay together
    const ivec3 first = first_voxel - grow >> 2, last = first_voxel + 4 * (cells - 1) + (cells > 1 ? 3 : 0) + grow >> 2;
    bool found = false;
    for (int i = 0; i < side * side * side; ++i) {
        const ivec3 cell = min(first + ivec3(i % side, i / side % side, i / (side * side)), last);
        found = cell_is_occupied(params, job, cell) || found;
    }
    return found;
}

// Where a voxel, in voxels from the brick's corner, lies in the images of cells of `side` voxels.
ivec3 cell_texel(const OcclusionParams params, const OcclusionJob job, ivec3 voxel, uint shift)
{
    const uint entry = entry_at(params.reach, voxel >> 5);
#ifdef PAGED
    const ivec3 in_brick = int(BRICK_SIZE) * ivec3(job.brick) + voxel >> int(entry >> OCCLUSION_LEVEL_SHIFT) & 31;
#else
    const ivec3 in_brick = voxel & 31;
#endif
    return ivec3((BRICK_SIZE >> shift) * unpack_slot(entry)) + (in_brick >> int(shift));
}

struct Ray {
    vec3 origin;
    vec3 direction;
    vec3 lift;
};

ivec3 voxel_at(const Ray ray, uint tap)
{
    return ivec3(floor(ray.origin + taps.list[tap].distance * ray.direction + taps.list[tap].lift * ray.lift));
}

// x: light that is left; y: what came in.
vec2 after(vec2 light, uint tap, uint code)
{
    const float left = passed.by_code[tap * 256u + code];
    return vec2(light.x * left, light.y + light.x * taps.list[tap].stretch * (0.5 + 0.5 * left));
}

float along(const OcclusionParams params, const OcclusionJob job, const Ray ray, ivec3 voxel)
{
    vec2 light = vec2(1.0, params.first);
    uint tap = 0u;
    for (; tap < params.taps_end[0]; ++tap) {
        const ivec3 at = voxel_at(ray, tap);
        const uint code = imageLoad(cells_1, cell_texel(params, job, at, 0u)).x;
        light = after(light, tap, at == voxel ? 0u : code);   // where voxels are long, a step may not leave one
    }
    for (; tap < params.taps_end[1]; ++tap)
        light = after(light, tap, imageLoad(cells_2, cell_texel(params, job, voxel_at(ray, tap), 1u)).x);
    for (; tap < params.taps_end[2]; ++tap)
        light = after(light, tap, imageLoad(cells_4, cell_texel(params, job, voxel_at(ray, tap), 2u)).x);
    return light.y;
}

// To the voxel, and to where other bricks keep a copy of it. An apron that no brick of this level writes repeats its edge.
void store(const OcclusionParams params, const OcclusionJob job, ivec3 voxel, uint value)
{
    const ivec3 side = ivec3(equal(voxel, ivec3(31))) - ivec3(equal(voxel, ivec3(0)));
    const uint copies = side == ivec3(0) ? 1u : 8u;
    for (uint i = 0u; i < copies; ++i) {
        const ivec3 offset = side * ivec3(i & 1u, i >> 1u & 1u, i >> 2u);
        const uint entry = entry_at(params.reach, offset);
        const bool is_there = entry != 0u && entry >> OCCLUSION_LEVEL_SHIFT == 0u;
        const ivec3 in_slot = is_there ? voxel - 32 * offset : voxel + offset;
        imageStore(values, ivec3(slot_origin(is_there ? entry : job.slot)) + int(BRICK_APRON) + in_slot, uvec4(value));
    }
}

void main()
{
    const OcclusionParams params = params_block.data;
    const OcclusionJob job = jobs.list[gl_WorkGroupID.x];
    const uint lane = gl_LocalInvocationIndex, side = 2u * params.reach + 1u;
    for (uint i = lane; i < side * side * side; i += 64u) around[i] = bricks_around.entries[job.around + i];
    if (lane == 0u) block_count = 0u;
    barrier();
    // Skipped by trip counts, never by branches: SIMD devices run those masked.
    const ivec3 own_block = 8 * ivec3(lane & 3u, lane >> 2u & 3u, lane >> 4u);
    const bool is_mine = lane % OCCLUSION_SPLIT == gl_WorkGroupID.z;
    if (is_mine && any_cell_is_occupied(params, job, own_block, 2)) blocks[atomicAdd(block_count, 1u)] = lane;
    barrier();

    const uint turns = 8u * block_count;
    for (uint turn = 0u; turn < turns; ++turn) {
        const uint block = blocks[turn >> 3u];
        const ivec3 voxel = 8 * ivec3(block & 3u, block >> 2u & 3u, block >> 4u) +
                            ivec3(gl_LocalInvocationID.xy, turn & 7u);
        const uint rays = any_cell_is_occupied(params, job, voxel, 1) ? params.rays : 0u;

        const ivec3 texel = ivec3(slot_origin(job.slot)) + int(BRICK_APRON) + voxel;
        const vec3 slope = 0.5 * params.inverse_spacing *
                           vec3(code_at(texel + ivec3(1, 0, 0)) - code_at(texel - ivec3(1, 0, 0)),
                                code_at(texel + ivec3(0, 1, 0)) - code_at(texel - ivec3(0, 1, 0)),
                                code_at(texel + ivec3(0, 0, 1)) - code_at(texel - ivec3(0, 0, 1)));
        const float square = dot(slope, slope), fade = params.gradient_fade * params.gradient_fade;
        const bool has_side = square > 0.0 && params.full_sphere == 0u;
        const float surface = has_side ? square / (square + fade) : 0.0;
        const vec3 normal = has_side ? -slope * inversesqrt(square) : vec3(0.0);

        float sum = 0.0;
        Ray ray;
        ray.origin = vec3(voxel) + 0.5;
        ray.lift = surface * normal * params.inverse_spacing;
        for (uint k = 0u; k < rays; ++k) {
            // Rays from behind the surface come from before it; the weaker the surface, the fewer do.
            const vec3 direction = directions.list[k].xyz;
            const vec3 ahead = dot(direction, normal) < surface - 1.0 ? -direction : direction;
            ray.direction = ahead * params.inverse_spacing;
            sum += along(params, job, ray, voxel);
        }
        const float value = sum / (params.radius * float(params.rays));
        if (rays > 0u) store(params, job, voxel, uint(255.0 * min(value, 1.0) + 0.5));
    }
}
