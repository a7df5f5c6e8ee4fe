// One brick per workgroup: its opacity, in cells of two sizes (occlusion.h).
// variants: PAGED FILTERED MASKED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#include "occlusion.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(binding = 0, scalar) readonly buffer Params { OcclusionCellsParams data; } params_block;
layout(binding = 1, scalar) readonly buffer Jobs { OcclusionCellsJob list[]; } jobs;
layout(binding = 2, scalar) readonly buffer Opacities { float values[]; } opacities;   // of one unit, from the table
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

float opacity_at(const OcclusionCellsParams params, const OcclusionCellsJob job, uvec3 voxel)
{
#ifdef PAGED
    const ivec3 first = place_in_slot(job.slot);
#else
    const ivec3 first = place_of_first() + ivec3(BRICK_SIZE * job.brick);
#endif
    const float opacity = opacity_of(params, code_at(first + ivec3(voxel)));
    const float held = opacity_held(params, float(1u << params.level) * (vec3(job.brick * BRICK_SIZE + voxel) + 0.5));
    return held < 0.0 ? opacity : held;
}

uvec4 code_of(vec3 opacity)
{
    const uvec3 code = uvec3(255.0 * sqrt(clamp(opacity, 0.0, 1.0)) + 0.5);
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
    const uvec3 slot = unpack_slot(job.slot);
    for (uint z = 0u; z < 8u; ++z) {
        const uvec3 block = uvec3(gl_LocalInvocationID.xy, z);   // of 4^3 voxels
        // Light left by columns of four voxels: along x by yz, along y by xz, along z by xy.
        vec4 left_x[4] = vec4[4](vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0)), left_y[4] = left_x, left_z[4] = left_x;
        for (uint octant = 0u; octant < 8u; ++octant) {
            const uvec3 of_cube = corner_of_cube(octant), half_block = 2u * block + of_cube;
            float left[8];
            for (uint corner = 0u; corner < 8u; ++corner)
                left[corner] = 1.0 - opacity_at(params, job, 2u * half_block + corner_of_cube(corner));
            const vec4 x = vec4(left[0] * left[1], left[2] * left[3], left[4] * left[5], left[6] * left[7]);
            const vec4 y = vec4(left[0] * left[2], left[1] * left[3], left[4] * left[6], left[5] * left[7]);
            const vec4 z = vec4(left[0] * left[4], left[1] * left[5], left[2] * left[6], left[3] * left[7]);
            left_x[of_cube.y + 2u * of_cube.z] *= x;
            left_y[of_cube.x + 2u * of_cube.z] *= y;
            left_z[of_cube.x + 2u * of_cube.y] *= z;
            const vec3 through = vec3(dot(x, vec4(0.25)), dot(y, vec4(0.25)), dot(z, vec4(0.25)));
            imageStore(cells_2, ivec3(BRICK_SIZE / 2u * slot + half_block), code_of(1.0 - through));
        }
        vec3 through = vec3(0.0);
        for (uint i = 0u; i < 4u; ++i)
            through += vec3(dot(left_x[i], vec4(1.0)), dot(left_y[i], vec4(1.0)), dot(left_z[i], vec4(1.0)));
        imageStore(cells_4, ivec3(BRICK_SIZE / 4u * slot + block), code_of(1.0 - through / 16.0));
    }
}
