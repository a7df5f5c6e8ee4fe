// Mixes each pixel with the same pixel of another picture, in premultiplied linear light. Equal pixels keep their bits.
// One pixel per thread.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../mix.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push
{
    MixParams params;
};
layout(binding = 0, rgba32f) uniform readonly image2D other;
layout(binding = 1, rgba32f) uniform image2D color;

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, params.size))) return;
    const ivec2 texel = ivec2(params.target + at);
    const vec4 light = imageLoad(color, texel);
    precise vec4 mixed = light + params.share * (imageLoad(other, ivec2(at)) - light);
    imageStore(color, texel, mixed);
}
