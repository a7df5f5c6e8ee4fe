// Converts premultiplied linear light to 8-bit sRGB over an opaque colour, at original size or enlarged. One texel per
// thread. At original size, the result differs by at most one level of 255 from the file written by
// engine/base/image.cpp.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "../encode.h"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(constant_id = 0) const uint ENLARGED = 0u;
layout(push_constant, scalar) uniform Push { EncodeParams params; };
layout(binding = 0, rgba32f) uniform readonly image2D color;
layout(binding = 1, rgba8) uniform writeonly image2D display;

vec4 light_at(ivec2 texel)
{
    return imageLoad(color, clamp(texel, ivec2(0), ivec2(params.last)));
}

// Linear interpolation between texel centres.
vec4 enlarged(vec2 at)
{
    const vec2 corner = floor(at - 0.5);
    const vec2 fraction = at - 0.5 - corner;
    const ivec2 texel = ivec2(corner);
    const vec4 upper = mix(light_at(texel), light_at(texel + ivec2(1, 0)), fraction.x);
    const vec4 lower = mix(light_at(texel + ivec2(0, 1)), light_at(texel + ivec2(1, 1)), fraction.x);
    return mix(upper, lower, fraction.y);
}

// IEC 61966-2-1.
float encoded(float linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * exp2(log2(linear) / 2.4) - 0.055;
}

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, params.size))) return;
    const vec2 source = params.first + vec2(at) * params.step;
    const vec4 light = ENLARGED != 0u ? enlarged(source) : light_at(ivec2(source));
    const vec3 seen = clamp(light.rgb + (1.0 - light.a) * params.behind, 0.0, 1.0);
    vec4 shown = vec4(encoded(seen.r), encoded(seen.g), encoded(seen.b), 1.0);
    if (params.swap_red_blue != 0u) shown = shown.bgra;
    imageStore(display, ivec2(params.target + at), shown);
}
