#pragma once
// How a volume looks, whoever looks at it from wherever: what pictures depend on beside camera and probe. Plain values.

#include "engine/look/groups.h"
#include "engine/look/panes.h"
#include "engine/look/settings.h"
#include "engine/look/transfer_function.h"

namespace shvr {

struct Look {
    TransferFunction transfer_function;
    Groups groups;
    Light light;
    DistanceBlend blend;
    CutBox cut;
    RenderSettings render;
    SliceSettings slices;
};

/// Whether a light makes ambient occlusion.
inline bool shows_occlusion(const Light& light)
{
    return light.shaded && light.ambient > 0.0 && light.occlusion.strength > 0.0;
}

}  // namespace shvr
