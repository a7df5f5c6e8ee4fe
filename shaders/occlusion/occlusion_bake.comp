// Computes how much light reaches every potentially visible voxel of a brick, by the definition in occlusion.h. A ray
// takes three samples in ramps of voxels, three in ramps of cells of two voxels and two in cells of four. PAGED: cells
// are those of paged bricks. STRETCHED: 0 if voxels are cubes, otherwise 1 or 2. At 2, all samples in cells use cells
// of two voxels, since cells of four are longer than the distances to be resolved.
// variants: PAGED FILTERED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
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
#ifdef PAGED
layout(binding = 5, r32ui) uniform readonly uimage3D around_2;
layout(binding = 6, r32ui) uniform readonly uimage3D around_4;
#else
// Reads outside the volume return 0 (robustImageAccess), which stands for an empty cell.
layout(binding = 5, r32ui) uniform readonly uimage3D cells_2;
layout(binding = 6, r32ui) uniform readonly uimage3D cells_4;
#define around_2 cells_2
#define around_4 cells_4
#endif
layout(binding = 7, r8ui) uniform writeonly uimage3D values;
#ifdef PAGED
layout(binding = 8, r8ui) uniform readonly uimage3D cell_leap;
#else
layout(binding = 8, r32ui) uniform readonly uimage3D leap;
#endif
layout(constant_id = 0) const uint STRETCHED = 0u;
layout(binding = 9, scalar) readonly buffer VisibleIntervals { uint before[]; } visible_intervals;

layout(binding = 10, scalar) readonly buffer Opacities { OcclusionEntry entries[]; } opacities;   // as for gathering

#include "occlusion_around.glsl"
#ifdef PAGED
#define STACKED 20
#endif
#include "../library/voxel_code.glsl"
#include "occlusion_opacity.glsl"

OcclusionBakeParams params;
#include "../library/occupancy.glsl"

// These constants were found by optimization: they minimize the errors over the cases of
// tests/gpu/occlusion/occlusion_light_test.cpp. MARGIN_4: distance, in units, by which a cell of 4^3 voxels counts as
// nearer to the surface than it is.
const float MARGIN_4 = 0.853;
// Scales the share of a cell of 4^3 voxels that is attributed to the surface.
const float WALL_4 = 8.2;
// How much the opacity of a cell of 4^3 voxels is concentrated at the start of the stretch.
const float BEND_4 = 0.08;
// Ramps are softened with distance, because a ray also stands for the directions around it.
const float SOFT_NEAR[] = {1.25, 0.874, 0.734}, SOFT_2[] = {0.751, 0.59, 0.527, 0.5, 0.45};
const float STEEPEST_OF_VOXELS = 3.3, STEEPEST_OF_CELLS = 2.6;   // occlusion_ramp.glsl

#include "occlusion_listed.glsl"

// Positions are relative to the block of 4^3 voxels that contains the voxel. These numbers of voxels are added so that
// positions are positive when truncated. The arithmetic is thus the same for every brick and apron.
const int NEAR_AHEAD = 4, CELLS_AHEAD = 64;

// Converts positions relative to the block to texels of the scratch images, which hold jobs stacked along z, and to
// cells of a resident volume. The box that blocks light is in the same coordinates; space outside the box is empty.
struct Block {
    ivec3 to_near, to_2, to_4;
    vec3 lower, upper;
};

Block block_of(const OcclusionJob of, ivec3 voxel)
{
    const ivec3 first = voxel & ~3;
    const ivec3 job = ivec3(scratch_place(gl_WorkGroupID.x));
    const vec3 begin = vec3(ivec3(BRICK_SIZE * of.brick) + first);
    const float share = 1.0 / float(1u << params.voxels.level);
    const int side_2 = int(BRICK_SIZE >> 1u), side_4 = int(BRICK_SIZE >> 2u);
#ifdef PAGED
    const ivec2 aprons = ivec2(params.aprons[0], params.aprons[1]);
    const ivec3 brick_2 = aprons[0] + (side_2 + 2 * aprons[0]) * job;
    const ivec3 brick_4 = aprons[1] + (side_4 + 2 * aprons[1]) * job;
#else
    const ivec3 brick_2 = side_2 * ivec3(of.brick), brick_4 = side_4 * ivec3(of.brick);
#endif
    return Block(first + (int(NEAR_APRON) - NEAR_AHEAD) + int(NEAR_SIDE) * job,
                 (first >> 1) - CELLS_AHEAD / 2 + brick_2, (first >> 2) - CELLS_AHEAD / 4 + brick_4,
                 share * params.voxels.lower - begin, share * params.voxels.upper - begin);
}

// Densities on one side of a voxel along the steepest fall: a cubic up to the neighbours, constant beyond them.
struct Course {
    vec4 factors;
    float least, most;
};

// `to`: direction along the axes of the neighbours on this side. `rise`: each axis's share of a unit of length.
Course course_of(ivec3 texel, ivec3 to, vec3 rise, float own)
{
    const ivec3 x = ivec3(to.x, 0, 0), y = ivec3(0, to.y, 0), z = ivec3(0, 0, to.z);
    const vec3 one = vec3(code_at(texel + x), code_at(texel + y), code_at(texel + z));
    const vec3 two = vec3(code_at(texel + y + z), code_at(texel + x + z), code_at(texel + x + y));
    const float three = code_at(texel + to), ones = one.x + one.y + one.z, twos = two.x + two.y + two.z;
    const vec3 squares = vec3(rise.y * rise.z, rise.x * rise.z, rise.x * rise.y);
    Course course;
    course.factors.x = own;
    course.factors.y = dot(rise, one - own);
    course.factors.z = dot(squares, two - (ones - one) + own);
    course.factors.w = squares.z * rise.z * (three - twos + ones - own);
    const vec3 least = min(one, two), most = max(one, two);
    course.least = min(min(own, three), min(least.x, min(least.y, least.z)));
    course.most = max(max(own, three), max(most.x, max(most.y, most.z)));
    return course;
}

// `along` in voxels.
float opacity_along(const Course course, float along)
{
    const vec4 f = course.factors;
    const float code = f.x + along * (f.y + along * (f.z + along * f.w));
    return opacity_of(params.voxels, clamp(code, course.least, course.most));
}

// The fixed opacity of the voxel at `place`, regardless of density; below 0: none.
float held_at(const Block block, vec3 place)
{
    const ivec3 voxel = to_int(place + float(NEAR_AHEAD));
    const vec3 centre = vec3(voxel) - (float(NEAR_AHEAD) - 0.5);
    const bool is_inside = all(greaterThanEqual(centre, block.lower)) && all(lessThan(centre, block.upper));
    const uint packed = imageLoad(near, voxel + block.to_near).x;
    const float top = float(packed & 255u);
    const float held = ramp_height(packed) == RAMP_HELD ? top * top * (1.0 / 65025.0) : -1.0;
    return is_inside ? held : 0.0;
}

// The surface at a voxel, and the half-space behind the surface, which contributes to cells of 4^3 voxels but blocks no
// ray that leaves the surface.
struct Surface {
    vec3 normal;
    float strength;
    vec3 place;     // start of rays, in voxels from the block's corner
    vec3 heights;   // direction in which densities fall fastest, in voxels
    vec3 scale;     // share of a cell's columns behind the surface, per axis: base - scale * height in cells
    vec3 base;
    float height;   // distance of the surface: dot(heights, position), in cells
    float wall;     // opacity, over a tap's stretch, of the half-space behind the surface
};

float saturated(float share)
{
    const float rest = 1.0 - min(share, 1.0);
    return 1.0 - rest * rest;
}

// `slope` per voxel.
Surface surface_at(const Block block, ivec3 texel, vec3 centre, vec3 slope)
{
    Surface s;
    const float square = dot(slope, slope), fade = params.gradient_fade * params.gradient_fade;
    s.strength = square > 0.0 ? square / (square + fade) : 0.0;
    const vec3 step = square > 0.0 ? -slope * inversesqrt(square) : vec3(0.0, 0.0, 1.0);
    s.normal = STRETCHED != 0u ? normalize(step * params.inverse_spacing) : step;
    const float apart = OCCLUSION_EDGE_REACH / float(OCCLUSION_EDGE_TAPS);
    float before[OCCLUSION_EDGE_TAPS], behind[OCCLUSION_EDGE_TAPS], most = 0.0, clear = 1.0;
    const ivec3 to = ivec3(lessThan(vec3(0.0), step)) * 2 - 1;
    const vec3 rise = abs(step);
    const float own = code_at(texel), reach = 1.0 / max(rise.x, max(rise.y, rise.z));
    const Course in_front = course_of(texel, to, rise, own), at_back = course_of(texel, -to, rise, own);
    for (uint pair = 0u; pair < OCCLUSION_EDGE_TAPS / 2u; ++pair) {
        const vec3 between = float(2u * pair + 1u) * apart * step;
        const float held_before = held_at(block, centre + between), held_behind = held_at(block, centre - between);
        for (uint i = 2u * pair; i < 2u * pair + 2u; ++i) {
            const float within = min((float(i) + 0.5) * apart, reach);
            before[i] = held_before < 0.0 ? opacity_along(in_front, within) : held_before;
            behind[i] = held_behind < 0.0 ? opacity_along(at_back, within) : held_behind;
            most = max(most, behind[i]);
            clear = min(clear, before[i]);
        }
    }
    most = max(most, before[0]);
    const float inverse = 1.0 / max(most, 1e-6);
    float least = 1.0, greatest = 0.0, offset = 0.0;
    for (uint i = 0u; i < OCCLUSION_EDGE_TAPS; ++i) {
        least = min(least, saturated(before[i] * inverse));
        greatest = max(greatest, saturated(behind[i] * inverse));
        offset += apart * (least + greatest - 1.0);
    }
    offset = most < 1e-6 ? 0.0 : clamp(offset, -OCCLUSION_FURTHEST, OCCLUSION_FURTHEST);
    s.place = centre + s.strength * (offset + OCCLUSION_LIFT) * step;
    s.heights = step;
    const vec3 extent = abs(s.heights), across = extent.yzx + extent.zxy;
    s.scale = 1.0 / max(across, 0.1);
    s.base = 0.5 + 0.5 * extent * s.scale;
    const float left = clamp((1.0 - most) / max(1.0 - clear, 1e-6), 1e-4, 1.0);
    s.wall = s.strength * WALL_4 * (1.0 - pow(left, params.far_exponent));
    const float lift = MARGIN_4 - s.strength * OCCLUSION_LIFT;
    s.height = dot((s.place + float(CELLS_AHEAD)) * 0.25 - 0.5, s.heights) + 0.25 * lift;
    return s;
}

// Removes the half-space behind the surface from an opacity.
float beyond_surface(float opacity, float of_surface)
{
    const float own = min(of_surface, 0.95);
    return max(opacity - own, 0.0) / (1.0 - own);
}

// `leaves`: 1 if the ray points away from the surface, otherwise 0.
float cell_tap(const Surface s, ivec3 cell, uint packed, vec3 weights, float leaves)
{
    const vec3 code = vec3(uvec3(packed, packed >> 8u, packed >> 16u) & 255u);
    const float opacity = dot(weights, code * code) * (1.0 / 65025.0);
    const float height = dot(vec3(cell), s.heights) - s.height;
    const vec3 behind = clamp(s.base - height * s.scale, 0.0, 1.0);
    return beyond_surface(opacity, leaves * s.wall * dot(weights, behind));
}

// x: light left; y: light arrived so far. `left`: transmittance of the stretch; `half_left`: that of its first half.
vec2 after(vec2 light, float stretch, float left, float half_left)
{
    return vec2(light.x * left, light.y + light.x * stretch * half_left);
}

vec2 after_cell(vec2 light, float stretch, float stopped)
{
    return vec2(light.x * (1.0 - stopped), light.y + light.x * stretch * (1.0 - stopped * (0.5 + BEND_4 * stopped)));
}

// A ramp at maximum steepness stands for a sharper edge, so it is as steep in space as along the voxel's shortest side.
float sharpened_for(vec3 slope, float softened, float steepest)
{
    if (STRETCHED == 0u) return softened;
    const vec3 physical = slope * params.inverse_spacing;
    const float square = dot(slope, slope), most = RAMP_SLOPES * steepest;
    const float is_steepest = clamp((square / (most * most) - 0.5625) / 0.2475, 0.0, 1.0);
    return softened * mix(1.0, sqrt(square / max(dot(physical, physical), 1e-6)), is_steepest);
}

// The share of a ray's light left after the stretch of a ramp. The ray samples the ramp at an offset from the centre of
// the cube, whose side is 1. A ramp is `softened` about the middle of its rise.
float ramp_left(uint packed, vec3 from_middle, float softened, float steepest)
{
    const vec3 slope = vec3(ramp_slope(packed));
    const float along = dot(slope, from_middle), sharpened = sharpened_for(slope, softened, steepest);
    const float rise = float(ramp_height(packed)) + RAMP_HEIGHTS / RAMP_SLOPES * along;
    const float top = float(packed & 255u), share = clamp(0.5 + sharpened / RAMP_HEIGHTS * rise, 0.0, 1.0);
    return 1.0 - top * top * (1.0 / 65025.0) * share;   // 255^2 times this factor is exactly 1 in floats as well
}

float near_left(const Block block, vec3 place, float softened)
{
    const ivec3 voxel = to_int(place);
    return ramp_left(imageLoad(near, voxel + block.to_near).x, place - (vec3(voxel) + 0.5), softened,
                     STEEPEST_OF_VOXELS);
}

float left_of_2(const Block block, vec3 place, float softened)
{
    const ivec3 cell = to_int(place);
    return ramp_left(imageLoad(around_2, cell + block.to_2).x, place - (vec3(cell) + 0.5), softened,
                     STEEPEST_OF_CELLS);
}

// The weights of a cell's three opacities (along x, y and z) for a ray; `step` is in voxels.
vec3 weights_of(vec3 direction, vec3 step)
{
    return STRETCHED != 0u ? step * step / dot(step, step) : direction * direction;
}

// The light that arrives along a ray, in units. Uses neither buffers nor loops, because SIMD devices would run both
// lane by lane.
float along(const Surface s, const Block block, vec3 direction, float leaves, ivec3 in_block)
{
    const vec3 step = direction * params.inverse_spacing, weights = weights_of(direction, step);
    const vec3 begin = s.place + float(NEAR_AHEAD);
    const vec3 near_0 = begin + params.near_taps[0].distance * step;
    const vec3 near_1 = begin + params.near_taps[1].distance * step;
    const vec3 near_2 = begin + params.near_taps[2].distance * step;
    const ivec3 own = in_block + NEAR_AHEAD;
    float left_0 = near_left(block, near_0, SOFT_NEAR[0]), left_1 = near_left(block, near_1, SOFT_NEAR[1]);
    // The stretch of the last sample in voxels is twice as long as the stretches of the others.
    float half_2 = near_left(block, near_2, SOFT_NEAR[2]);
    half_2 = to_int(near_2) == own ? 1.0 : half_2;
    const float left_2 = half_2 * half_2;
    left_1 = to_int(near_1) == own ? max(left_1, left_2) : left_1;
    left_0 = to_int(near_0) == own ? max(left_0, left_1) : left_0;
    vec2 light = after(vec2(1.0, params.first), params.near_taps[0].stretch, left_0, sqrt(left_0));
    light = after(light, params.near_taps[1].stretch, left_1, sqrt(left_1));
    light = after(light, params.near_taps[2].stretch, left_2, half_2);

    const vec3 from_2 = 0.5 * (s.place + float(CELLS_AHEAD)), from_4 = 0.5 * from_2;
    const float far_0 = left_of_2(block, from_2 + 0.5 * params.taps_2[0].distance * step, SOFT_2[0]);
    const float far_1 = left_of_2(block, from_2 + 0.5 * params.taps_2[1].distance * step, SOFT_2[1]);
    const float far_2 = left_of_2(block, from_2 + 0.5 * params.taps_2[2].distance * step, SOFT_2[2]);
    light = after(light, params.taps_2[0].stretch, far_0, sqrt(far_0));
    light = after(light, params.taps_2[1].stretch, far_1, sqrt(far_1));
    light = after(light, params.taps_2[2].stretch, far_2, sqrt(far_2));

    if (STRETCHED == 2u) {
        const float far_3 = left_of_2(block, from_2 + 0.5 * params.taps_4[0].distance * step, SOFT_2[3]);
        const float far_4 = left_of_2(block, from_2 + 0.5 * params.taps_4[1].distance * step, SOFT_2[4]);
        light = after(light, params.taps_4[0].stretch, far_3, sqrt(far_3));
        return after(light, params.taps_4[1].stretch, far_4, sqrt(far_4)).y;
    }
    const ivec3 cell_0 = to_int(from_4 + 0.25 * params.taps_4[0].distance * step);
    const ivec3 cell_1 = to_int(from_4 + 0.25 * params.taps_4[1].distance * step);
    const uint packed_0 = imageLoad(around_4, cell_0 + block.to_4).x;
    const uint packed_1 = imageLoad(around_4, cell_1 + block.to_4).x;
    light = after_cell(light, params.taps_4[0].stretch, cell_tap(s, cell_0, packed_0, weights, leaves));
    return after_cell(light, params.taps_4[1].stretch, cell_tap(s, cell_1, packed_1, weights, leaves)).y;
}

// Stores the value at the voxel and at the voxel's copies in other bricks (paged bricks compute their own copies).
// Aprons without a brick of this level repeat their edge voxels.
void store(const OcclusionJob job, ivec3 voxel, bool is_apron, uint value)
{
    const ivec3 side = ivec3(equal(voxel, ivec3(31))) - ivec3(equal(voxel, ivec3(0)));
    const uint copies = is_apron || side == ivec3(0) ? 1u : 8u;
    for (uint i = 0u; i < copies; ++i) {
        const ivec3 offset = side * ivec3(i & 1u, i >> 1u & 1u, i >> 2u);
        const uint entry = entry_at(params.reach, offset);
        const bool is_there = entry != 0u && entry >> OCCLUSION_LEVEL_SHIFT == 0u;
#ifdef PAGED
        if (is_there && offset != ivec3(0)) continue;
        imageStore(values, ivec3(slot_origin(job.slot)) + int(BRICK_APRON) + voxel + offset, uvec4(value));
#else
        const ivec3 in_slot = is_there ? voxel - 32 * offset : voxel + offset;
        imageStore(values, ivec3(slot_origin(is_there ? entry : job.slot)) + int(BRICK_APRON) + in_slot, uvec4(value));
#endif
    }
}

void main()
{
    params = params_block.data;
    const OcclusionJob job = jobs.list[gl_WorkGroupID.x];
    load_around(job, params.reach);
    list_voxels(job);

    const uint count = voxel_count, turns = (count + 63u) / 64u;
    for (uint turn = 0u; turn < turns; ++turn) {
        const uint index = 64u * turn + gl_LocalInvocationIndex;
        const uint listed = voxels[min(index, count - 1u) >> 1u] >> 16u * (index & 1u) & 0xffffu;
        const uint rays = index < count ? params.rays : 0u;
#ifdef PAGED
        const bool is_apron = (listed & IN_APRON) != 0u;
        const ivec3 voxel = is_apron ? apron_voxel(listed - IN_APRON) : voxel_of(listed >> 6u, listed & 63u);
#else
        const bool is_apron = false;
        const ivec3 voxel = voxel_of(listed >> 6u, listed & 63u);
#endif
        const Block block = block_of(job, voxel);
        const ivec3 in_block = voxel & 3;

        const ivec3 texel = texel_of(job, voxel);
        const vec3 slope = 0.5 * vec3(code_at(texel + ivec3(1, 0, 0)) - code_at(texel - ivec3(1, 0, 0)),
                                      code_at(texel + ivec3(0, 1, 0)) - code_at(texel - ivec3(0, 1, 0)),
                                      code_at(texel + ivec3(0, 0, 1)) - code_at(texel - ivec3(0, 0, 1)));
        const Surface surface = surface_at(block, texel, vec3(in_block) + 0.5, slope);
        // Two unit vectors orthogonal to the normal and to each other (Duff et al. 2017).
        const vec3 n = surface.normal;
        const float up = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (up + n.z), b = n.x * n.y * a;
        const vec3 one = vec3(1.0 + up * n.x * n.x * a, up * b, -up * n.x), other = vec3(b, up + n.y * n.y * a, -n.y);
        // Directions reach behind the surface down to a height of -open; lower ones are mirrored to the front.
        const float open = params.full_sphere != 0u ? 1.0 : 1.0 - surface.strength;

        float sum = 0.0;
        vec2 turned = vec2(1.0, 0.0);
        const float share = 1.0 / float(params.rays);
        for (uint k = 0u; k < rays; ++k) {
            // Spherical Fibonacci points (Gonzalez 2010) about the normal; twice as dense where mirrored rays are added
            const float height_share = 1.0 - share * (float(k) + 0.5);
            const float height = height_share < open ? 2.0 * height_share - open : height_share;
            const vec2 beside = sqrt(max(1.0 - height * height, 0.0)) * turned;
            turned = vec2(turned.x * params.turn_cos - turned.y * params.turn_sin,
                          turned.x * params.turn_sin + turned.y * params.turn_cos);
            sum += along(surface, block, beside.x * one + beside.y * other + height * n, float(height > 1e-4),
                         in_block);
        }
        const float value = sum * share / params.radius;
        if (rays > 0u) store(job, voxel, is_apron, to_uint(255.0 * min(value, 1.0) + 0.5));
    }
}
