#pragma once
// The region around a moving probe in which relevance should be known. The window's mirror and simulations
// (haptics/replay) request regions by this rule. Neither of their folders may include the other, so the rule is here.

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

namespace shvr {

/// The probe's ball in physical units, and the time in seconds until an answer arrives.
struct RegionWish {
    glm::dvec3 point{0.0};     ///< the ball's centre
    double radius = 1.0;       ///< radius of the ball
    glm::dvec3 velocity{0.0};  ///< velocity of `point`
    double latency_s = 0.0;    ///< time from requesting a region until the servo uses it

    /// Distance and direction in which the ball moves until the answer arrives.
    glm::dvec3 travel() const { return latency_s * velocity; }
    /// Returns the middle of the best region with half sides `half`: half-way between the ball's position when this
    /// answer arrives and its position when the next answer arrives, but never so far ahead that the present ball would
    /// lie outside.
    glm::dvec3 region_middle(const glm::dvec3& half) const
    {
        const glm::dvec3 most = glm::max(half - radius, glm::dvec3(0.0));
        return point + glm::clamp(1.5 * travel(), -most, most);
    }
};

/// Time from a request until the servo uses the answer, in a window at 60 pictures a second: up to 8 ms until the
/// mirror runs, then one picture for the pass. Simulations assume this time.
inline constexpr double WINDOW_LATENCY_S = 0.024;

/// Whether to request another region. `held`: the current region, with `covers(centre, radius)`. `margin`: half its
/// side minus the ball's radius. At rest: once half of the margin is used up. In motion: early enough for the answer.
template <class Place>
bool is_region_due(const Place& held, const RegionWish& wish, double margin)
{
    return !held.covers(wish.point, wish.radius + 0.5 * std::max(margin, 0.0)) ||
           !held.covers(wish.point + wish.travel(), wish.radius);
}

}  // namespace shvr
