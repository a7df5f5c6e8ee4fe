// Parameters of the pass that turns light into what a screen shows.
#ifndef SHVR_ENCODE_H
#define SHVR_ENCODE_H
#include "shared.h"

SHARED_BEGIN

struct EncodeParams {
    uvec2 target;        ///< first texel that is written
    uvec2 size;          ///< texels that are written
    vec2 first;          ///< where in the source the middle of that texel lies; texel i has its middle at i + 0.5
    vec2 step;           ///< source texels per target texel
    uvec2 last;          ///< texel of the source; beyond it nothing was drawn
    vec3 behind;         ///< linear light that is seen through a translucent background
    uint swap_red_blue;  ///< as some screens have it
};

SHARED_END
#endif
