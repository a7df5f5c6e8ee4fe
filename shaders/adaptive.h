// Adaptive pictures: first traces rays through every second pixel of every second row, then through all pixels of the
// blocks in which those differ; elsewhere colours are interpolated. (Levoy, Volume rendering by adaptive refinement,
// The Visual Computer 6, 1990.)
#ifndef SHVR_ADAPTIVE_H
#define SHVR_ADAPTIVE_H
#include "shared.h"

SHARED_BEGIN

/// Size of a block in pixels: 4 x 2, i.e. eight pixels, one vector on CPUs. Blocks begin at multiples of this size in
/// the whole picture, whichever part of it is drawn.
SHARED_CONST uint ADAPTIVE_BLOCK_X = 4u;
SHARED_CONST uint ADAPTIVE_BLOCK_Y = 2u;
/// Blocks per workgroup of the refining kernels.
SHARED_CONST uint ADAPTIVE_BLOCKS_IN_GROUP = 8u;

/// Pixel (x, y) of the coarse picture has the ray of pixel (2 x, 2 y) of the picture.
struct AdaptiveParams {
    uvec2 pixel_begin;  ///< the part of the picture that is drawn
    uvec2 pixel_end;
    uvec2 target;     ///< texel of pixel_begin
    float tolerance;  ///< tolerated difference of colours, in square roots of linear light, 0 ... 1
    uint groups_in_dispatch;
};

/// The part's first block begins at this pixel.
SHARED_FUNCTION uvec2 adaptive_begin(uvec2 pixel_begin)
{
    return uvec2(pixel_begin.x - pixel_begin.x % ADAPTIVE_BLOCK_X, pixel_begin.y - pixel_begin.y % ADAPTIVE_BLOCK_Y);
}

/// Number of blocks of the part along x and y. They are listed by number, along x first.
SHARED_FUNCTION uvec2 adaptive_blocks(uvec2 pixel_begin, uvec2 pixel_end)
{
    const uvec2 pixels = pixel_end - adaptive_begin(pixel_begin);
    return uvec2((pixels.x + ADAPTIVE_BLOCK_X - 1u) / ADAPTIVE_BLOCK_X,
                 (pixels.y + ADAPTIVE_BLOCK_Y - 1u) / ADAPTIVE_BLOCK_Y);
}

/// Marks list entries beyond the end.
SHARED_CONST uint NO_BLOCK = 0xffffffffu;

SHARED_END
#endif
