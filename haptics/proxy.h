#pragma once
// The proxy by exact integration: instead of sampling points in the probe's ball, every row of relevant voxels is cut
// to the chord that lies in the ball and integrated along x in closed form. The result is continuous in the probe's
// place, since a chord's length goes to 0 at the ball's rim. Across y and z a row is a line through its voxels'
// middles, or, for small balls, four or nine lines.
//
// Two laws:
//   mean      proxy = mean of the relevant points in the ball: the thesis's (eq. 3.3 to 3.5) without sampling noise
//   potential offset = sum(a - p) / (sum(1 - |a - p|^2 / r^2) + eps N): the gradient of log(S + eps N), so no loop of
//             the hand gains energy, and the force grows from 0 when the first voxel enters. N is the ball's volume.
//
// Pure; any thread. Cost: 10 to 20 ns a line.

#include <glm/glm.hpp>

#include "haptics/relevance.h"

namespace shvr {

/// Integrals over the relevant part of the ball, in physical units.
struct BallIntegrals {
    double volume = 0.0;    ///< of 1
    glm::dvec3 first{0.0};  ///< of a - p
    double second = 0.0;    ///< of |a - p|^2
};
BallIntegrals integrate(const RelevancePatch& patch, const glm::dvec3& centre, double radius) noexcept;

enum class ProxyLaw : uint8_t { potential, mean };

struct Proxy {
    bool in_contact = false;      ///< something relevant is in the ball
    glm::dvec3 offset{0.0};       ///< proxy - probe, physical units; 0 without contact
    double relevant_share = 0.0;  ///< of the ball's volume
};
inline constexpr double POTENTIAL_FLOOR = 0.05;  ///< eps above
Proxy find_proxy(const RelevancePatch& patch, const glm::dvec3& centre, double radius, ProxyLaw law) noexcept;

}  // namespace shvr
