// Parameters of the pass that mixes two pictures.
#ifndef SHVR_MIX_H
#define SHVR_MIX_H
#include "shared.h"

SHARED_BEGIN

struct MixParams {
    uvec2 target;  ///< first texel of the picture to change
    uvec2 size;    ///< texels
    float share;   ///< weight of the other picture
};

SHARED_END
#endif
