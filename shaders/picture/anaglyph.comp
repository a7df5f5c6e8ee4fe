// Combines red from one eye's picture with green and blue from the other's. One pixel per thread.
#version 460

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant) uniform Push { uvec2 size; uvec2 target; };
layout(binding = 0, rgba32f) uniform readonly image2D left;
layout(binding = 1, rgba32f) uniform readonly image2D right;
layout(binding = 2, rgba32f) uniform writeonly image2D color;

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, size))) return;
    const vec4 red = imageLoad(left, ivec2(at)), rest = imageLoad(right, ivec2(at));
    // A pixel that is opaque for one eye is opaque in the result.
    imageStore(color, ivec2(target + at), vec4(red.r, rest.gb, max(red.a, rest.a)));
}
