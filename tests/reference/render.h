#pragma once
// The double-precision reference renderer, which tests compare the device with. It shares no code with the program.
// Include this header; fill in a `Scene`; then
//
//     const glm::dvec4 pixel = over_background(integrate_exact(scene, ray), scene);
//     const std::vector<glm::dvec4> image = render(scene, rays, DiscreteOptions{.step = 0.25});
//
// Slow: through 64^3 voxels one core takes about 3000 rays a second exactly (300 shaded), 50000 (20000) in discrete
// steps of half a voxel. Any thread may call anything here.

#include <span>
#include <variant>

#include "tests/reference/discrete.h"
#include "tests/reference/exact.h"
#include "tests/reference/scene.h"
#include "tests/reference/span.h"

namespace shvr::reference {

using Mode = std::variant<ExactOptions, DiscreteOptions>;

/// C and A of each ray, C not yet over the background. The result does not depend on the number of threads.
/// Throws std::invalid_argument if `check` does.
std::vector<glm::dvec4> render(const Scene& scene, std::span<const Ray> rays, const Mode& mode, int threads = 2);

/// C + (1 - A) background, linear RGB, and A. If A is 0 the result is the background, bit for bit.
glm::dvec4 over_background(const glm::dvec4& light, const Scene& scene);

/// Throws std::invalid_argument with a message if voxel counts do not match `size`, a spacing is not above 0, or an
/// opacity lies outside [0, 1].
void check(const Scene& scene);

}  // namespace shvr::reference
