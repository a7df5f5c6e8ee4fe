#pragma once
// Blinn-Phong shading that fades where there is no surface; the equations stand at `Shading` in scene.h.

#include "tests/reference/scene.h"

namespace shvr::reference {

/// Before the clamp to 1; the colour itself where the scene is not shaded. `to_eye`: physical space, unit.
glm::dvec3 lit(const Scene& scene, const glm::dvec3& voxel, const glm::dvec3& to_eye, const glm::dvec3& color);

/// After it.
glm::dvec3 shaded(const Scene& scene, const glm::dvec3& voxel, const glm::dvec3& to_eye, const glm::dvec3& color);

}  // namespace shvr::reference
