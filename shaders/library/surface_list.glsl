// Reads surfaces or triangles, and the boxes around them (surfaces.h).

layout(binding = 3, rgba32ui) uniform readonly uimage2D surface_nodes;
layout(binding = 4, rgba32ui) uniform readonly uimage2D surface_list;

ivec2 first_texel(uint index, uint texels)
{
    return ivec2(texels * (index % SURFACES_IN_ROW), index / SURFACES_IN_ROW);
}

SurfaceNode surface_node(uint index)
{
    const ivec2 at = first_texel(index, SURFACE_NODE_TEXELS);
    const uvec4 lower = imageLoad(surface_nodes, at), upper = imageLoad(surface_nodes, at + ivec2(1, 0));
    const uint end = imageLoad(surface_nodes, at + ivec2(2, 0)).x;
    return SurfaceNode(uintBitsToFloat(lower.xyz), lower.w, uintBitsToFloat(upper.xyz), upper.w, end, uvec3(0u));
}

Surface surface_at(uint index)
{
    const ivec2 at = first_texel(index, SURFACE_TEXELS);
    const uvec4 from = imageLoad(surface_list, at), along = imageLoad(surface_list, at + ivec2(1, 0));
    const uvec4 rest = imageLoad(surface_list, at + ivec2(2, 0)), color = imageLoad(surface_list, at + ivec2(3, 0));
    return Surface(uintBitsToFloat(from.xyz), uintBitsToFloat(from.w), uintBitsToFloat(along.xyz),
                   uintBitsToFloat(along.w), uintBitsToFloat(rest.xyz), rest.w, uintBitsToFloat(color.xyz), 0u);
}

Triangle triangle_at(uint index)
{
    const ivec2 at = first_texel(index, SURFACE_TEXELS);
    const uvec4 a = imageLoad(surface_list, at), b = imageLoad(surface_list, at + ivec2(1, 0));
    const uvec4 c = imageLoad(surface_list, at + ivec2(2, 0)), color = imageLoad(surface_list, at + ivec2(3, 0));
    return Triangle(uintBitsToFloat(a.xyz), a.w, uintBitsToFloat(b.xyz), b.w, uintBitsToFloat(c.xyz), c.w,
                    uintBitsToFloat(color.xyz), color.w);
}
