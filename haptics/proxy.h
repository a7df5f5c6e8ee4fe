#pragma once
// The proxy by exact integration: instead of sampling points in the probe's ball, each row of relevant voxels is
// clipped to its chord in the ball and integrated along x in closed form. The result is a continuous function of the
// probe's position, since chords shrink to 0 at the ball's rim. Across y and z, a row is represented by a line through
// its voxels' centres or, for small balls, by four or nine lines.
//
// Three laws (a: relevant point, p: probe, r: radius):
//   mean      proxy = mean of the relevant points in the ball: as in the thesis (eq. 3.3, 3.4), without sampling noise
//   potential offset = sum(a - p) / (sum(1 - |a - p|^2 / r^2) + eps N): the gradient of log(S + eps N), so no loop of
//             the hand gains energy, and the force grows from 0 when the first voxel enters. N is the ball's volume.
//   thesis    mean over 3000 points drawn once at random, as in the thesis: noisy and not continuous (1.7 to 2.5 %
//             of the radius where `mean` has 0.1 %). For comparison
//
// Where the ball sticks out of the patch, the integral leaves the unknown part out instead of taking it as empty: both
// sides are cut alike (KnownPart), and the offset is weighted by the known share. So nothing pulls along a straight
// tube at the border of the known region, and the pull fades to 0 as the centre reaches that border.
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
/// Integrates over the ball, without the voxels that are farther than `reach` from the centre along any axis.
BallIntegrals integrate(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                        const glm::dvec3& reach) noexcept;
inline BallIntegrals integrate(const RelevancePatch& patch, const glm::dvec3& centre, double radius) noexcept
{
    return integrate(patch, centre, radius, glm::dvec3(radius));
}

inline constexpr int SAMPLE_POINTS = 3000;  ///< as in the thesis

struct Proxy {
    bool in_contact = false;      ///< the ball contains relevant voxels
    glm::dvec3 offset{0.0};       ///< proxy - probe, physical units; 0 without contact
    glm::dvec3 mean{0.0};         ///< mean of the relevant points minus probe, for every law
    double relevant_share = 0.0;  ///< relevant share of the known part of the ball, by volume
};
inline constexpr double POTENTIAL_FLOOR = 0.05;  ///< eps above
Proxy find_proxy(const RelevancePatch& patch, const glm::dvec3& centre, double radius, ProxyLaw law) noexcept;

/// Returns the vector from the ball's centre to the middle of the structure that the ball touches, where tools act. The
/// middle is the exact mean in a second ball around the first ball's exact mean, since the rim of the first ball cuts
/// more off the far side of a thick tube. In balls of 1.5 times a tube's radius, the second mean is within 0.11 voxels
/// of the axis (RMS, guided hand), the first mean within 0.65.
glm::dvec3 find_middle(const RelevancePatch& patch, const glm::dvec3& centre, double radius, ProxyLaw law,
                       const Proxy& proxy) noexcept;

// ---- By sample points, for comparison (`shvr haptics bench --sweep`)
// --------------------------------------------------

/// Returns random points of uniform density in the unit ball (algorithm 2 of the thesis); the same on every machine.
std::vector<glm::dvec3> random_points(int count);
/// Returns low-discrepancy points in the unit ball: an additive recurrence with the plastic number (Roberts 2018),
/// mapped to equal volumes.
std::vector<glm::dvec3> even_points(int count);
/// Returns the proxy as the mean of those points in `points` that are relevant.
Proxy find_sampled_proxy(const RelevancePatch& patch, const glm::dvec3& centre, double radius,
                         std::span<const glm::dvec3> points) noexcept;

}  // namespace shvr
