#pragma once
// The look of a volume: every input of a picture, except the camera and the probe. Plain values.

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
    bool shows_meshes = true;  ///< the trace, surfaces and the probe's ball
};

/// Whether a light uses ambient occlusion.
inline bool shows_occlusion(const Light& light)
{
    return light.shaded && light.ambient > 0.0 && light.occlusion.strength > 0.0;
}

}  // namespace shvr
