#pragma once
// The picture of scene.h as a plain sum over very many samples: where no closed form exists, this is what the exact
// model is checked against. Written apart from the models, and shares nothing with them but the scene.

#include "tests/reference/scene.h"

namespace shvr::reference {

/// Midpoint sum over equal steps from t_in to t_out of the ray, both inside the volume; the cut box is not looked at.
/// Opacities must stay below 1, points must be sorted, and a fade of 0 must not be asked for. C and A.
glm::dvec4 brute_force(const Scene& scene, const Ray& ray, double t_in, double t_out, int samples);

}  // namespace shvr::reference
