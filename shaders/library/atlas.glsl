// Texels of the atlas of densities, at places that slot_origin gives (bricks.h). Needs `atlas`: r32ui, two codes in a
// texel, or FILTERED, a sampler3D of R16_UNORM codes.
//
// STACKED: where one image of the device cannot hold enough paged bricks there are several, all of the same size, one
// upon the other along z: ATLASES of them. Those that are not there are bound to the first, and never read. A brick
// lies in one image, with all that is read for a sample in it.
#ifndef SHVR_ATLAS_GLSL
#define SHVR_ATLAS_GLSL

#ifdef STACKED
layout(constant_id = 13) const uint ATLASES = 1u;
#ifdef FILTERED
layout(binding = STACKED) uniform sampler3D atlas_1;
layout(binding = STACKED + 1) uniform sampler3D atlas_2;
layout(binding = STACKED + 2) uniform sampler3D atlas_3;
#else
layout(binding = STACKED, r32ui) uniform readonly uimage3D atlas_1;
layout(binding = STACKED + 1, r32ui) uniform readonly uimage3D atlas_2;
layout(binding = STACKED + 2, r32ui) uniform readonly uimage3D atlas_3;
#endif

// The image that holds z, of so many texels each.
int atlas_of(int z, int height)
{
    return int(z >= height) + int(z >= 2 * height) + int(z >= 3 * height);
}
#endif

#ifdef FILTERED
float atlas_texel(ivec3 at)
{
#ifdef STACKED
    if (ATLASES > 1u) {
        const int height = textureSize(atlas, 0).z, which = atlas_of(at.z, height);
        at.z -= which * height;
        if (which == 1) return texelFetch(atlas_1, at, 0).x;
        if (which == 2) return texelFetch(atlas_2, at, 0).x;
        if (which == 3) return texelFetch(atlas_3, at, 0).x;
    }
#endif
    return texelFetch(atlas, at, 0).x;
}
#else
uint atlas_pair(ivec3 at)
{
#ifdef STACKED
    if (ATLASES > 1u) {
        const int height = imageSize(atlas).z, which = atlas_of(at.z, height);
        at.z -= which * height;
        if (which == 1) return imageLoad(atlas_1, at).x;
        if (which == 2) return imageLoad(atlas_2, at).x;
        if (which == 3) return imageLoad(atlas_3, at).x;
    }
#endif
    return imageLoad(atlas, at).x;
}
#endif

#endif
