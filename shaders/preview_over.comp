// Lays a share of what preview.comp has found over the picture: all of it shows where the volume hides it, and slices
// show what is below. Where the picture ends at it already, nothing changes. One thread a pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "preview.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { PreviewOverParams params; };
layout(binding = 0, rgba32f) uniform readonly image3D seen;
layout(binding = 1, rgba32f) uniform image3D color;

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, params.size))) return;
    const vec4 over = imageLoad(seen, ivec3(at, 0));
    if (over.a == 0.0) return;
    const ivec3 texel = ivec3(params.target + at, 0);
    imageStore(color, texel, mix(imageLoad(color, texel), vec4(over.rgb, 1.0), params.share));
}
