// How much light reaches every potentially visible voxel of a brick (occlusion.h): the mean over rays of the share of
// the radius along which light arrives. Value of a ray = (1 / radius) sum over stretches of length * light left in
// their middle. Only voxels in occupied cells are computed: the ranges of cells overlap by a voxel, so a visible sample
// reads no others. PAGED: cells are those of paged bricks.
// variants: PAGED FILTERED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../pages.h"
#include "occlusion_bake.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(binding = 0, scalar) readonly buffer Params { OcclusionBakeParams data; } params_block;
layout(binding = 1, scalar) readonly buffer Jobs { OcclusionJob list[]; } jobs;
layout(binding = 2, scalar) readonly buffer Around { uint entries[]; } bricks_around;
#ifdef FILTERED
layout(binding = 3) uniform sampler3D atlas;
#else
layout(binding = 3, r32ui) uniform readonly uimage3D atlas;
#endif
layout(binding = 4, r32ui) uniform readonly uimage3D near;
layout(binding = 5, r8ui) uniform readonly uimage3D around_2;
layout(binding = 6, r8ui) uniform readonly uimage3D around_4;
layout(binding = 7, r8ui) uniform writeonly uimage3D values;
#ifdef PAGED
layout(binding = 8, r8ui) uniform readonly uimage3D cell_leap;
#else
layout(binding = 8, r32ui) uniform readonly uimage3D leap;
#endif

#include "occlusion_around.glsl"
#include "../library/voxel_code.glsl"

const uint CELLS_OF_ONE = BRICK_CELLS * BRICK_CELLS * BRICK_CELLS / OCCLUSION_SPLIT;
shared uint cells[CELLS_OF_ONE];
shared uint cell_count;

// Whether any of these voxels is in an occupied cell, or with `grow` within one voxel of such a cell.
bool any_cell_is_occupied(const OcclusionBakeParams params, const OcclusionJob job, ivec3 first_voxel, ivec3 last_voxel)
{
    const int grow = int(params.grow), side = 1 + 2 * grow;   // the same for all lanes, so that they stay together
    const ivec3 first = first_voxel - grow >> 2, last = last_voxel + grow >> 2;
    bool found = false;
    for (int i = 0; i < side * side * side; ++i) {
        const ivec3 cell = min(first + ivec3(i % side, i / side % side, i / (side * side)), last);
        found = cell_is_occupied(params.reach, params.cell_counts, job, cell) || found;
    }
    return found;
}

struct Ray {
    vec3 origin;   // voxels from the brick's corner
    vec3 direction;
    vec3 lift;
};

vec3 place_of(const Ray ray, const OcclusionTap tap)
{
    return ray.origin + tap.distance * ray.direction + tap.lift * ray.lift;
}

// x: light left; y: light that arrived.
vec2 after(vec2 light, const OcclusionTap tap, float opacity)
{
    const float left = 1.0 - opacity;
    return vec2(light.x * left, light.y + light.x * tap.stretch * (0.5 + 0.5 * left));
}

float opacity_of(uint code)
{
    return float(code * code) * (1.0 / 65025.0);
}

// Reads no buffer, and no loop count is variable: SIMD devices would run those lane by lane.
float along(const OcclusionBakeParams params, const Ray ray, ivec3 voxel)
{
    const int behind = int(gl_WorkGroupID.x);
    const ivec3 aprons = ivec3(OCCLUSION_NEAR_APRON, params.aprons[0], params.aprons[1]);
    const ivec3 beyond = (ivec3(BRICK_SIZE, BRICK_SIZE >> 1u, BRICK_SIZE >> 2u) + 2 * aprons) * behind;
    vec2 light = vec2(1.0, params.first);
    for (uint i = 0u; i < OCCLUSION_TAPS_EACH; ++i) {
        const OcclusionTap tap = params.taps[i];
        const ivec3 half_voxel = ivec3(floor(2.0 * place_of(ray, tap))), at = half_voxel >> 1, half_of = half_voxel & 1;
        const uint packed = imageLoad(near, at + aprons.x + ivec3(0, 0, beyond.x)).x;
        const float opacity = near_opacity(packed, uint(half_of.x | half_of.y << 1 | half_of.z << 2));
        light = after(light, tap, at == voxel ? 0.0 : opacity);   // where voxels are long, a step may not leave one
    }
    for (uint i = 0u; i < OCCLUSION_TAPS_EACH; ++i) {
        const OcclusionTap tap = params.taps[OCCLUSION_TAPS_EACH + i];
        const ivec3 at = ivec3(floor(0.5 * place_of(ray, tap))) + aprons.y + ivec3(0, 0, beyond.y);
        light = after(light, tap, opacity_of(imageLoad(around_2, at).x));
    }
    for (uint i = 0u; i < OCCLUSION_TAPS_EACH; ++i) {
        const OcclusionTap tap = params.taps[2u * OCCLUSION_TAPS_EACH + i];
        const ivec3 at = ivec3(floor(0.25 * place_of(ray, tap))) + aprons.z + ivec3(0, 0, beyond.z);
        light = after(light, tap, opacity_of(imageLoad(around_4, at).x));
    }
    return light.y;
}

// Stores the value at the voxel and at its copies in other bricks. Aprons that no brick of this level writes repeat
// their edge voxels.
void store(const OcclusionBakeParams params, const OcclusionJob job, ivec3 voxel, uint value)
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
    const OcclusionBakeParams params = params_block.data;
    const OcclusionJob job = jobs.list[gl_WorkGroupID.x];
    const uint lane = gl_LocalInvocationIndex;
    load_around(job, params.reach);
    if (lane == 0u) cell_count = 0u;
    barrier();
    // Skipped by loop counts, never by branches: SIMD devices execute branches masked.
    for (uint i = lane; i < CELLS_OF_ONE; i += 64u) {
        const uint cell = i * OCCLUSION_SPLIT + gl_WorkGroupID.z;
        const ivec3 first = 4 * ivec3(cell & 7u, cell >> 3u & 7u, cell >> 6u);
        if (any_cell_is_occupied(params, job, first, first + 3)) cells[atomicAdd(cell_count, 1u)] = cell;
    }
    barrier();

    const uint turns = cell_count;
    for (uint turn = 0u; turn < turns; ++turn) {
        const uint cell = cells[turn];
        const ivec3 voxel = 4 * ivec3(cell & 7u, cell >> 3u & 7u, cell >> 6u) +
                            ivec3(lane & 3u, lane >> 2u & 3u, lane >> 4u);
        const uint rays = any_cell_is_occupied(params, job, voxel, voxel) ? params.rays : 0u;

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
        vec2 turned = vec2(1.0, 0.0);
        const float apart = 2.0 / float(params.rays);
        for (uint k = 0u; k < rays; ++k) {
            // Spherical Fibonacci points (Gonzalez 2010).
            const float height = 1.0 - apart * (float(k) + 0.5);
            const vec3 direction = vec3(sqrt(1.0 - height * height) * turned, height);
            turned = vec2(turned.x * params.turn_cos - turned.y * params.turn_sin,
                          turned.x * params.turn_sin + turned.y * params.turn_cos);
            // Rays from behind the surface are mirrored to its front; the weaker the surface, the fewer are.
            const vec3 ahead = dot(direction, normal) < surface - 1.0 ? -direction : direction;
            ray.direction = ahead * params.inverse_spacing;
            sum += along(params, ray, voxel);
        }
        const float value = sum / (params.radius * float(params.rays));
        if (rays > 0u) store(params, job, voxel, uint(255.0 * min(value, 1.0) + 0.5));
    }
}
