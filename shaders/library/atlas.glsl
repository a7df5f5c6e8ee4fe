// Reads texels of the density atlas. Needs bricks.h, GL_EXT_buffer_reference and `atlas`: an r32ui image or, if
// FILTERED, a sampler3D of R16_UNORM codes. Codes have 16 bits. A texel of r32ui contains two codes along x, the first
// in its low half. In 8-bit volumes (CODE_BYTES is 1), codes are multiples of 257 and a texel contains four of them.
//
// Paged bricks are in slots; bricks of a resident volume are contiguous (bricks.h).
//
// STACKED: if one image cannot hold enough paged bricks, there are several images (ATLASES) of the same size, stacked
// along z. Bindings without an image of their own get the first image, and are never read. A brick lies in a single
// image, together with all texels that its samples read.
#ifndef SHVR_ATLAS_GLSL
#define SHVR_ATLAS_GLSL

#ifdef FILTERED
const uint CODE_BYTES = 2u;
#else
layout(constant_id = 15) const uint CODE_BYTES = 2u;
const int WORD_SHIFT = CODE_BYTES == 1u ? 2 : 1;   // shift that converts a code's x coordinate to that of its word
const uint CODE_BITS = 8u * CODE_BYTES;
const uint CODE_MASK = CODE_BYTES == 1u ? 0xffu : 0xffffu;
const uint CODE_UNIT = CODE_BYTES == 1u ? 257u : 1u;

// BY_ADDRESS: the texels are words of a buffer, x fastest, instead of an image's.
layout(constant_id = 16) const uint BY_ADDRESS = 0u;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AtlasWords { uint at[]; };
layout(binding = 31, scalar) readonly buffer AtlasAt {
    AtlasWords words;
    uvec3 size;
} atlas_at;
// Read once: loops would read them at each use.
AtlasWords atlas_words = atlas_at.words;
uvec3 atlas_size = atlas_at.size;
uint atlas_slice = atlas_size.x * atlas_size.y, last_atlas_word = atlas_slice * atlas_size.z - 1u;

// The right shift that moves the code at x to the low bits of its word.
uint shift_to(int x)
{
    return uint(x & (1 << WORD_SHIFT) - 1) * CODE_BITS;
}
#endif

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

// The index of the image that contains z, if each image is `height` texels high.
int atlas_of(int z, int height)
{
    return int(z >= height) + int(z >= 2 * height) + int(z >= 3 * height);
}
#endif

// The position of a brick's first voxel in the atlas, given the brick's slot.
ivec3 place_in_slot(uint slot)
{
    return ivec3(slot_codes(CODE_BYTES) * unpack_slot(slot) + BRICK_APRON);
}

// The position of the first voxel in an atlas of contiguous bricks.
ivec3 place_of_first()
{
    return ivec3(code_border());
}

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
uint atlas_word(ivec3 at)
{
    if (BY_ADDRESS != 0u) {
        const uint word = uint(at.x) + atlas_size.x * uint(at.y) + atlas_slice * uint(at.z);
        return atlas_words.at[min(word, last_atlas_word)];
    }
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

// The last position along x in an atlas of contiguous bricks.
int last_along_x()
{
#ifdef FILTERED
    return textureSize(atlas, 0).x - 1;
#else
    return ((BY_ADDRESS != 0u ? int(atlas_size.x) : imageSize(atlas).x) << WORD_SHIFT) - 1;
#endif
}

#endif
