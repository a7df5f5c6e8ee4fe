#pragma once
// The picture of scene.h as a plain sum over very many samples: the check of the exact model where no closed form
// exists. Independent of the models: it shares only the scene with them.

#include "tests/reference/scene.h"

namespace shvr::reference {

/// Midpoint sum over equal steps from t_in to t_out of the ray, both inside the volume; ignores the cut box. Opacities
/// must be below 1, points sorted, and the fade not 0. Returns C and A.
glm::dvec4 brute_force(const Scene& scene, const Ray& ray, double t_in, double t_out, int samples);

}  // namespace shvr::reference
