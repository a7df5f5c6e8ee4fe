// Computes the opacity of one brick per workgroup, in ramps of cells of 2^3 voxels and in cells of 4^3 (occlusion.h).
// variants: PAGED FILTERED MASKED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "occlusion.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(binding = 0, scalar) readonly buffer Params { OcclusionCellsParams data; } params_block;
layout(binding = 1, scalar) readonly buffer Jobs { OcclusionCellsJob list[]; } jobs;
layout(binding = 2, scalar) readonly buffer Opacities { OcclusionEntry entries[]; } opacities;   // over a tap's stretch
#ifdef FILTERED
layout(binding = 3) uniform sampler3D atlas;
#else
layout(binding = 3, r32ui) uniform readonly uimage3D atlas;
#endif
layout(binding = 4, r32ui) uniform writeonly uimage3D cells_2;
layout(binding = 5, r32ui) uniform writeonly uimage3D cells_4;
#include "occlusion_opacity.glsl"
#ifdef PAGED
#define STACKED 20
#endif
#include "../library/voxel_code.glsl"
#include "occlusion_ramp.glsl"

// x: the voxel's density. y: the voxel's fixed opacity; negative if the opacity is not fixed.
vec2 voxel_at(const OcclusionCellsParams params, const OcclusionCellsJob job, uvec3 voxel)
{
#ifdef PAGED
    const ivec3 first = place_in_slot(job.slot);
#else
    const ivec3 first = place_of_first() + ivec3(BRICK_SIZE * job.brick);
#endif
    const vec3 centre = float(1u << params.level) * (vec3(job.brick * BRICK_SIZE + voxel) + 0.5);
    return vec2(code_at(first + ivec3(voxel)), opacity_held(params, centre));
}

// Differences along each axis between the voxels of a cell of 2^3: `a` at the lower z, `b` at the higher z.
vec3 slope_of(vec4 a, vec4 b)
{
    const vec4 x = vec4(a.yw - a.xz, b.yw - b.xz), y = vec4(a.zw - a.xy, b.zw - b.xy);
    return 0.25 * vec3(dot(x, vec4(1.0)), dot(y, vec4(1.0)), dot(b - a, vec4(1.0)));
}

float least_of(vec4 v)
{
    return min(min(v.x, v.y), min(v.z, v.w));
}

float most_of(vec4 v)
{
    return max(max(v.x, v.y), max(v.z, v.w));
}

// Computes the ramp of a cell: from opacities instead of densities if any voxel's opacity is fixed.
uint ramp_of_cell(const OcclusionCellsParams params, vec4 codes[2], vec4 opacities_of[2], bool is_held)
{
    const vec4 a = is_held ? opacities_of[0] : codes[0], b = is_held ? opacities_of[1] : codes[1];
    const vec3 slope = slope_of(a, b);
    const float middle = 0.125 * dot(a + b, vec4(1.0)), least = least_of(min(a, b)), most = most_of(max(a, b));
    const float square = 0.125 * dot(a * a + b * b, vec4(1.0)), inverse = 1.0 / max(most, 1e-10);
    const vec3 direction = slope / max(length(slope), 1e-6);
    const uint of_held = packed_ramp(most, middle * inverse, square * inverse * inverse, direction,
                                     STEEPEST_OF_CELLS);
    const uint of_codes = ramp_of(params, middle, 2.0 * slope, least, most, STEEPEST_OF_CELLS);
    return is_held ? of_held : of_codes;
}

uvec4 code_of(vec3 opacity)
{
    const uvec3 code = to_uint(255.0 * sqrt(clamp(opacity, 0.0, 1.0)) + 0.5);
    return uvec4(code.x | code.y << 8u | code.z << 16u);
}

uvec3 corner_of_cube(uint i)
{
    return uvec3(i & 1u, i >> 1u & 1u, i >> 2u);
}

void main()
{
    const OcclusionCellsParams params = params_block.data;
    const OcclusionCellsJob job = jobs.list[gl_WorkGroupID.x];
#ifdef PAGED
    const uvec3 place = unpack_slot(job.slot);
#else
    const uvec3 place = job.brick;
#endif
    for (uint z = 0u; z < 8u; ++z) {
        const uvec3 block = uvec3(gl_LocalInvocationID.xy, z);   // of 4^3 voxels
        // Transmittances of columns of four voxels: along x, indexed by (y, z); along y, by (x, z); along z, by (x, y).
        vec4 left_x[4] = vec4[4](vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0)), left_y[4] = left_x, left_z[4] = left_x;
        for (uint octant = 0u; octant < 8u; ++octant) {
            const uvec3 of_cube = corner_of_cube(octant), half_block = 2u * block + of_cube;
            vec4 codes[2], found[2];
            bool is_held = false;
            for (uint corner = 0u; corner < 8u; ++corner) {
                const vec2 voxel = voxel_at(params, job, 2u * half_block + corner_of_cube(corner));
                codes[corner >> 2u][corner & 3u] = voxel.x;
                found[corner >> 2u][corner & 3u] = voxel.y < 0.0 ? opacity_of(params, voxel.x) : voxel.y;
                is_held = is_held || voxel.y >= 0.0;
            }
            const float left[8] = float[8](1.0 - found[0].x, 1.0 - found[0].y, 1.0 - found[0].z, 1.0 - found[0].w,
                                           1.0 - found[1].x, 1.0 - found[1].y, 1.0 - found[1].z, 1.0 - found[1].w);
            const vec4 x = vec4(left[0] * left[1], left[2] * left[3], left[4] * left[5], left[6] * left[7]);
            const vec4 y = vec4(left[0] * left[2], left[1] * left[3], left[4] * left[6], left[5] * left[7]);
            const vec4 z = vec4(left[0] * left[4], left[1] * left[5], left[2] * left[6], left[3] * left[7]);
            left_x[of_cube.y + 2u * of_cube.z] *= x;
            left_y[of_cube.x + 2u * of_cube.z] *= y;
            left_z[of_cube.x + 2u * of_cube.y] *= z;
            imageStore(cells_2, ivec3(BRICK_SIZE / 2u * place + half_block),
                       uvec4(ramp_of_cell(params, codes, found, is_held)));
        }
        vec3 through = vec3(0.0);
        const vec4 exponent = vec4(params.far_exponent);
        for (uint i = 0u; i < 4u; ++i)
            through += vec3(dot(pow(left_x[i], exponent), vec4(1.0)), dot(pow(left_y[i], exponent), vec4(1.0)),
                            dot(pow(left_z[i], exponent), vec4(1.0)));
        imageStore(cells_4, ivec3(BRICK_SIZE / 4u * place + block), code_of(1.0 - through / 16.0));
    }
}
