// Parameters of the pass that converts linear light to a screen's pixels.
#ifndef SHVR_ENCODE_H
#define SHVR_ENCODE_H
#include "shared.h"

SHARED_BEGIN

struct EncodeParams {
    uvec2 target;        ///< first texel to write
    uvec2 size;          ///< texels to write
    vec2 first;          ///< centre of the first texel, in source texels; texel i has its centre at i + 0.5
    vec2 step;           ///< source texels per target texel
    uvec2 last;          ///< last valid texel of the source; nothing was drawn beyond it
    vec3 behind;         ///< linear light behind a translucent background
    uint swap_red_blue;  ///< for screens in BGR order
};

SHARED_END
#endif
