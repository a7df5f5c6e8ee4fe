// Keeps the nearer of two surfaces at each pixel; at equal lengths, the picture's own. Texels as written by
// rays/surfaces.comp: alpha is the length along the ray. One pixel per thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../nearer.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push
{
    NearerParams params;
};
layout(binding = 0, rgba32f) uniform readonly image2D other;
layout(binding = 1, rgba32f) uniform image2D surfaces;

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, params.size))) return;
    const vec4 seen = imageLoad(other, ivec2(at));
    if (seen.a < imageLoad(surfaces, ivec2(at)).a) imageStore(surfaces, ivec2(at), seen);
}
