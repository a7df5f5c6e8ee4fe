// Blends the voxels found by preview.comp over the picture, partly transparent. They show even if the volume hides
// them; in slices, the values below stay visible. Rays that end at such a voxel are unchanged. One thread per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../preview.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { PreviewOverParams params; };
layout(binding = 0, rgba32f) uniform readonly image2D seen;
layout(binding = 1, rgba32f) uniform image2D color;

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, params.size))) return;
    const vec4 over = imageLoad(seen, ivec2(at));
    if (over.a == 0.0) return;
    const ivec2 texel = ivec2(params.target + at);
    imageStore(color, texel, mix(imageLoad(color, texel), vec4(over.rgb, 1.0), params.share));
}
