#pragma once
// Scenes and rays for tests of the renderers. Equal seeds give equal bits on every machine.

#include <functional>
#include <random>

#include "tests/reference/scene.h"

namespace shvr::reference {

/// `density` is evaluated at every voxel centre.
Scene scene_of(const glm::ivec3& size, const std::function<double(glm::dvec3 voxel)>& density);

/// Independent densities, uniform in [0, 1]: the roughest field a grid holds.
Scene noise_scene(const glm::ivec3& size, uint32_t seed);

/// From a random point on a sphere around the volume to a random point inside.
Ray random_ray(const Scene& scene, std::mt19937& random);

}  // namespace shvr::reference
