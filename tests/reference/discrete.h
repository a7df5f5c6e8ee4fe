#pragma once
// The ideal picture of a stepped renderer: the same samples, composited in double. Compared with the device it shows
// rounding; compared with exact.h it shows the error of the method.
//
// With S the length of the ray inside the volume, in reference voxels, and n = floor(S / step): sample i = 0 ... n-1
// stands for [i step, (i+1) step]; where r = S - n step > 0, one more stands for the rest. A sample is taken at the
// given share of its stretch, of length l, and composited front to back:
//     a' = 1 - (1 - alpha)^l,   C += T c a',   T *= 1 - a'
// c is not multiplied by opacity before any interpolation.

#include "tests/reference/scene.h"
#include "tests/reference/span.h"
#include "tests/reference/transfer.h"

namespace shvr::reference {

struct DiscreteOptions {
    double step = 0.5;       ///< reference voxels
    double sample_at = 0.5;  ///< share of the stretch: 0.5 its middle, 0 its front end
    /// The ray stops once A is at least this; 2 = never.
    double stop_opacity = 2.0;
    /// 0: the transfer function itself. Otherwise a table of colour and opacity a' of a stretch, both linear between
    /// entries; entry k at x_0 + k (x_1 - x_0) / (entries - 1), over what the function and the densities, 0 to 1, have
    /// in common. The rest of a ray has a table of its own length.
    uint32_t table_entries = 0;
};

/// Prepared once for many rays; borrows the scene. Any thread may call `integrate`.
class DiscreteModel {
public:
    DiscreteModel(const Scene& scene, const DiscreteOptions& options);
    /// C and A; C is not yet over the background.
    glm::dvec4 integrate(const Ray& ray) const;

private:
    glm::dvec3 blended(const glm::dvec3& voxel, const glm::dvec3& color) const;
    glm::dvec4 sample(const glm::dvec3& voxel, const glm::dvec3& to_eye, double length) const;
    glm::dvec4 looked_up(double density, double length) const;

    const Scene& scene_;
    DiscreteOptions options_;
    Transfer transfer_;
    std::vector<glm::dvec4> table_;  ///< opacities of a reference voxel
    double first_ = 0.0, last_ = 0.0;
};

glm::dvec4 integrate_discrete(const Scene& scene, const Ray& ray, const DiscreteOptions& options = {});

}  // namespace shvr::reference
