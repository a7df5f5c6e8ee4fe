// Parameters of the pass that desaturates a picture.
#ifndef SHVR_SATURATION_H
#define SHVR_SATURATION_H
#include "shared.h"

SHARED_BEGIN

struct SaturationParams {
    uvec2 target;      ///< first texel of the picture to change
    uvec2 size;        ///< texels
    float saturation;  ///< 1: unchanged colours; 0: the grey of the same luminance
};

SHARED_CONST float LUMINANCE_OF_RED = 0.2126f;   ///< weights of the luminance in linear sRGB (IEC 61966-2-1, Rec. ITU-R
                                                 ///< BT.709)
SHARED_CONST float LUMINANCE_OF_BLUE = 0.0722f;  ///< green has the rest

SHARED_END
#endif
