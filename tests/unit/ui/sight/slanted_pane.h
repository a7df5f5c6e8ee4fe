#pragma once
// An anisotropic volume and a pane that shows it from an oblique angle, for tests of handles.

#include "engine/look/panes.h"

namespace shvr {

inline VolumeInfo volume()
{
    VolumeInfo info;
    info.size = {100, 80, 60};
    info.spacing = {1.0, 2.0, 0.5};
    return info;
}

inline Camera slanted(Camera::Projection projection)
{
    Camera camera;
    camera.projection = projection;
    camera.eye = {260.0, -150.0, 140.0};
    camera.target = {50.0, 80.0, 15.0};
    camera.height = 200.0;
    return camera;
}

inline Pane pane_of(const Camera& camera)
{
    return {.kind = Pane::Kind::main, .shot = camera, .box = {{0, 0}, {640, 480}}, .name = "camera"};
}

}  // namespace shvr
