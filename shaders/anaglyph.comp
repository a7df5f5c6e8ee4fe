// Takes red from one eye's picture, green and blue from the other's. One pixel per thread.
#version 460

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(push_constant) uniform Push { uvec2 size; uvec2 target; };
layout(binding = 0, rgba32f) uniform readonly image3D left;
layout(binding = 1, rgba32f) uniform readonly image3D right;
layout(binding = 2, rgba32f) uniform writeonly image3D color;

void main()
{
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, size))) return;
    const vec4 red = imageLoad(left, ivec3(at, 0)), rest = imageLoad(right, ivec3(at, 0));
    // What is opaque for one eye is opaque for both.
    imageStore(color, ivec3(target + at, 0), vec4(red.r, rest.gb, max(red.a, rest.a)));
}
