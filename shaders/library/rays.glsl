// The pixel that a thread draws, and where its ray crosses a plane of points. The includer declares GROUP_WIDTH: a
// group's 64 threads cover GROUP_WIDTH x 64 / GROUP_WIDTH pixels.

// The pixel relative to the first pixel of the drawn part.
uvec2 thread_in_part()
{
    const uvec2 group_size = uvec2(GROUP_WIDTH, 64u / GROUP_WIDTH);
    const uvec2 in_group = uvec2(gl_LocalInvocationIndex % GROUP_WIDTH, gl_LocalInvocationIndex / GROUP_WIDTH);
    return gl_WorkGroupID.xy * group_size + in_group;
}

// `centre` in pixels.
vec3 on_plane(vec3 corner, vec3 dx, vec3 dy, vec2 centre)
{
    return corner + centre.x * dx + centre.y * dy;
}
