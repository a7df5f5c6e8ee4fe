#pragma once
// The picture as the equations of scene.h define it, with no step size: the ray is cut wherever the integrand stops
// being smooth (cell borders, voxel borders, transfer-function knots) and integrated adaptively in between. No early
// termination. Measured error: below 1e-12 (tests/unit/reference/reference_test.cpp).
//
// A control point of opacity 1 between points of lower opacity also ends the ray, though a stepped renderer, whose
// samples miss that single density, sees through it.

#include "tests/reference/scene.h"
#include "tests/reference/span.h"
#include "tests/reference/transfer.h"

namespace shvr::reference {

struct ExactOptions {
    double tolerance = 1e-12;  ///< absolute error of each smooth interval, as a fraction of the pixel
};

/// Prepared once for many rays; borrows the scene. Any thread may call `integrate`.
class ExactModel {
public:
    ExactModel(const Scene& scene, const ExactOptions& options);
    /// C and A of scene.h; C is not yet over the background.
    glm::dvec4 integrate(const Ray& ray) const;

private:
    const Scene& scene_;
    Transfer transfer_;
    ExactOptions options_;
};

glm::dvec4 integrate_exact(const Scene& scene, const Ray& ray, const ExactOptions& options = {});

}  // namespace shvr::reference
