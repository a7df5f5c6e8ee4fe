// Parameters of the pass that turns light into what a screen shows.
#ifndef SHVR_ENCODE_H
#define SHVR_ENCODE_H
#include "shared.h"

SHARED_BEGIN

struct EncodeParams {
    uvec2 source;  ///< first texel that is read
    uvec2 target;  ///< texel it goes to
    uvec2 size;    ///< texels
    vec3 behind;   ///< linear light that is seen through a translucent background
};

SHARED_END
#endif
