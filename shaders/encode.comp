// Linear light, premultiplied, to 8-bit sRGB over an opaque colour. One texel per thread; within one level of 255 of what
// engine/base/image.cpp writes to a file.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "encode.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant, scalar) uniform Push { EncodeParams params; };
layout(binding = 0, rgba32f) uniform readonly image3D color;
layout(binding = 1, rgba8) uniform writeonly image3D display;

// IEC 61966-2-1.
float encoded(float linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * exp2(log2(linear) / 2.4) - 0.055;
}

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, params.size))) return;
    const vec4 light = imageLoad(color, ivec3(params.source + at, 0));
    const vec3 seen = clamp(light.rgb + (1.0 - light.a) * params.behind, 0.0, 1.0);
    imageStore(display, ivec3(params.target + at, 0), vec4(encoded(seen.r), encoded(seen.g), encoded(seen.b), 1.0));
}
