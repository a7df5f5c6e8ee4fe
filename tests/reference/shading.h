#pragma once
// Blinn-Phong shading that fades where there is no surface; see `Shading` in scene.h for the equations.

#include "tests/reference/scene.h"

namespace shvr::reference {

/// Before the clamp to 1; the plain colour if the scene is not shaded. `to_eye`: physical space, unit.
glm::dvec3 lit(const Scene& scene, const glm::dvec3& voxel, const glm::dvec3& to_eye, const glm::dvec3& color);

/// After the clamp.
glm::dvec3 shaded(const Scene& scene, const glm::dvec3& voxel, const glm::dvec3& to_eye, const glm::dvec3& color);

}  // namespace shvr::reference
