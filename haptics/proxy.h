#pragma once
// The proxy by exact integration: instead of sampling points in the probe's ball, each row of relevant voxels is
// clipped to its chord in the ball and integrated along x in closed form. The result is a continuous function of the
// probe's position, since chords shrink to 0 at the ball's rim. Across y and z, a row is a line through its voxels'
// centres or, for small balls, four or nine lines.
//
// Three laws:
//   mean      proxy = mean of the relevant points in the ball: as in the thesis (eq. 3.3 - 3.5), without sampling noise
//   potential offset = sum(a - p) / (sum(1 - |a - p|^2 / r^2) + eps N): the gradient of log(S + eps N), so no loop of
//             the hand gains energy, and the force grows from 0 when the first voxel enters. N is the ball's volume.
//   thesis    mean over 3000 points drawn once at random, as in the thesis: noisy and not continuous (1.7 to 2.5 %
//             of the radius where `mean` has 0.1 %). For comparison
//
// Pure; any thread. Cost: 10 to 20 ns per line.

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/touch/touch_mode.h"
#include "haptics/relevance.h"

namespace shvr {

/// Integrals over the relevant part of the ball, in physical units.
struct BallIntegrals {
    double volume = 0.0;    ///< integral of 1
    glm::dvec3 first{0.0};  ///< integral of a - p
    double second = 0.0;    ///< integral of |a - p|^2
};
BallIntegrals integrate(const RelevancePatch& patch, const glm::dvec3& centre, double radius) noexcept;

inline constexpr int SAMPLE_POINTS = 3000;  ///< as in the thesis

struct Proxy {
    bool in_contact = false;      ///< the ball contains relevant voxels
    glm::dvec3 offset{0.0};       ///< proxy - probe, physical units; 0 without contact
    double relevant_share = 0.0;  ///< share of the ball's volume
};
inline constexpr double POTENTIAL_FLOOR = 0.05;  ///< eps above
Proxy find_proxy(const RelevancePatch& patch, const glm::dvec3& centre, double radius, ProxyLaw law) noexcept;

// ---- By sample points, for comparison (`shvr haptics bench --sweep`)
// --------------------------------------------------

/// Random points in a ball of radius 1, uniformly distributed (algorithm 2 of the thesis); the same on every machine.
std::vector<glm::dvec3> random_points(int count);
/// Likewise with low discrepancy: additive recurrence with the plastic number (Roberts 2018) over equal volumes.
std::vector<glm::dvec3> even_points(int count);
/// Returns the proxy at the mean of the relevant ones among these points.
Proxy find_sampled_proxy(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                         std::span<const glm::dvec3> points) noexcept;

}  // namespace shvr
