// Mixes each pixel with the grey of its luminance, in premultiplied linear light. Grey pixels and opacity keep their
// bits. One pixel per thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../saturation.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push
{
    SaturationParams params;
};
layout(binding = 0, rgba32f) uniform image2D color;

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, params.size))) return;
    const ivec2 texel = ivec2(params.target + at);
    const vec4 light = imageLoad(color, texel);
    // Computed relative to green, so that rounding keeps equal channels equal.
    precise float grey = light.g + LUMINANCE_OF_RED * (light.r - light.g) + LUMINANCE_OF_BLUE * (light.b - light.g);
    precise vec3 mixed = grey + params.saturation * (light.rgb - grey);
    imageStore(color, texel, vec4(mixed, light.a));
}
