// Parameters for ray-casting the voxels that a brush would change. Positions are in voxels, relative to the box around
// these voxels, and computed in double on the CPU, so that they stay accurate far from the volume's first corner.
#ifndef SHVR_PREVIEW_H
#define SHVR_PREVIEW_H
#include "shared.h"

SHARED_BEGIN

struct PreviewParams {
    vec3 near_corner;  ///< the ray of a pixel joins two points, as described in RaycastParams
    vec3 near_dx;
    vec3 near_dy;
    vec3 far_corner;
    vec3 far_dx;
    vec3 far_dy;
    ivec3 size;          ///< voxels of the box
    uint words_per_row;  ///< bit b of word w is x = 32 w + b
    vec3 lower;          ///< position of the box's first corner in the volume, in voxels
    vec3 color;          ///< linear light
    uint is_striped;     ///< marks voxels that would be erased: stripes differ from any colour, even for the
                         ///< colour-blind
};

struct PreviewOverParams {
    uvec2 target;  ///< first texel of the picture to change
    uvec2 size;    ///< texels
    float share;   ///< weight of the preview's colour
};

SHARED_CONST uint PREVIEW_STRIPE = 2u;  ///< voxels along x + y + z

SHARED_END
#endif
