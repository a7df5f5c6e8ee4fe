// Parameters of the pass that keeps the nearer of two pictures of surfaces.
#ifndef SHVR_NEARER_H
#define SHVR_NEARER_H
#include "shared.h"

SHARED_BEGIN

struct NearerParams {
    uvec2 size;  ///< texels
};

SHARED_END
#endif
