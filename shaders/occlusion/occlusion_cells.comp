// One brick per workgroup: its opacity, in cells of two sizes (occlusion.h).
// variants: PAGED FILTERED MASKED
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
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
layout(binding = 4, r8ui) uniform writeonly uimage3D cells_2;
layout(binding = 5, r8ui) uniform writeonly uimage3D cells_4;
#include "occlusion_opacity.glsl"
#include "../library/voxel_code.glsl"

float opacity_at(const OcclusionCellsParams params, const OcclusionCellsJob job, uvec3 voxel)
{
    const float opacity = opacity_of(params, code_at(ivec3(slot_origin(job.slot) + BRICK_APRON + voxel)));
    const float held = opacity_held(params, float(1u << params.level) * (vec3(job.brick * BRICK_SIZE + voxel) + 0.5));
    return held < 0.0 ? opacity : held;
}

uvec4 code_of(float opacity)
{
    return uvec4(uint(255.0 * sqrt(clamp(opacity, 0.0, 1.0)) + 0.5));
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
        float sum_4 = 0.0;
        for (uint octant = 0u; octant < 8u; ++octant) {
            const uvec3 half_block = 2u * block + corner_of_cube(octant);
            float sum_2 = 0.0;
            for (uint corner = 0u; corner < 8u; ++corner) {
                const uvec3 voxel = 2u * half_block + corner_of_cube(corner);
                const float one = opacity_at(params, job, voxel);
                const float two = one * (2.0 - one);   // 1 - (1 - a)^2
                sum_2 += two;
                sum_4 += two * (2.0 - two);
            }
            imageStore(cells_2, ivec3(BRICK_SIZE / 2u * slot + half_block), code_of(sum_2 / 8.0));
        }
        imageStore(cells_4, ivec3(BRICK_SIZE / 4u * slot + block), code_of(sum_4 / 64.0));
    }
}
