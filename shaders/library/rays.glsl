// The pixel that a thread draws, and where its ray crosses a plane of points. The includer declares GROUP_WIDTH, which
// is 8, 16 or 32: a group's 64 threads cover GROUP_WIDTH x 64 / GROUP_WIDTH pixels. Layers of groups are interleaved by
// rows (engine/passes/pixel_groups.h).

// The pixel relative to the first pixel of the drawn part. Every eight threads (one vector on CPUs) cover 4 x 2 pixels,
// since neighbouring rays are similar.
uvec2 thread_in_part()
{
    const uvec2 group_size = uvec2(GROUP_WIDTH, 64u / GROUP_WIDTH);
    const uvec2 group = uvec2(gl_WorkGroupID.x, gl_WorkGroupID.y * gl_NumWorkGroups.z + gl_WorkGroupID.z);
    const uint eight = gl_LocalInvocationIndex / 8u, in_eight = gl_LocalInvocationIndex % 8u;
    const uvec2 eights = uvec2(GROUP_WIDTH / 4u, 32u / GROUP_WIDTH);
    return group * group_size + uvec2(4u, 2u) * uvec2(eight % eights.x, eight / eights.x) +
           uvec2(in_eight % 4u, in_eight / 4u);
}

// Returns the point of a plane at the pixel position `centre`.
vec3 on_plane(vec3 corner, vec3 dx, vec3 dy, vec2 centre)
{
    return corner + centre.x * dx + centre.y * dy;
}
