#pragma once
// Adaptive Gauss-Legendre quadrature of the emission-absorption integral over one smooth stretch of a ray.

#include <functional>

#include <glm/glm.hpp>

namespace shvr::reference {

struct Medium {
    double extinction = 0.0;  ///< per reference voxel, finite
    glm::dvec3 color{0.0};
    /// The formula used for the colour. A change of formula is a kink, which is located even if no node shows it.
    unsigned formula = 0;
};

/// A stretch of a ray with nothing in front: optical depth, and integral of color * extinction * transparency.
struct Stretch {
    double depth = 0.0;
    glm::dvec3 light{0.0};
};

/// `front` before `back`.
Stretch joined(const Stretch& front, const Stretch& back);

/// Integrates `medium(s)` over [lower, upper]. Stretches are halved until each has an optical depth of at most 0.5 and
/// one 8-point rule agrees with two to `tolerance`, in depth and in light, or is 2^-48 of the whole. A stretch in which
/// the formula changes is halved until it is shorter than 1e-7, which leaves an error of about the square of that per
/// kink.
Stretch integrate(const std::function<Medium(double s)>& medium, double lower, double upper, double tolerance);

}  // namespace shvr::reference
