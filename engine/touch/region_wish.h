#pragma once
// Where the relevance around a moving probe should be known. The window's mirror and simulations (haptics/replay) ask
// by the same rule, and neither room includes the other.

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

namespace shvr {

/// The probe's ball, and how long an answer takes. Physical units and seconds.
struct RegionWish {
    glm::dvec3 point{0.0};     ///< the ball's centre
    double radius = 1.0;       ///< the ball's
    glm::dvec3 velocity{0.0};  ///< the point's
    double latency_s = 0.0;    ///< time from requesting a region until it is felt

    /// How far the ball moves until the answer arrives.
    glm::dvec3 travel() const { return latency_s * velocity; }
    /// The middle of the best region whose half sides are `half`: half-way between the ball when the answer to this
    /// question arrives and when the answer to the next one does, but never so far ahead that the present ball is
    /// outside.
    glm::dvec3 region_middle(const glm::dvec3& half) const
    {
        const glm::dvec3 most = glm::max(half - radius, glm::dvec3(0.0));
        return point + glm::clamp(1.5 * travel(), -most, most);
    }
};

/// From asking until the servo feels the answer, in the window at 60 pictures a second: up to 8 ms for the mirror's
/// turn, then one picture for the pass. Simulations use it.
inline constexpr double WINDOW_LATENCY_S = 0.024;

/// Whether another region is due, where `held` is a place with `covers(centre, radius)` and `margin` is half its side
/// minus the radius: at rest once half of the margin is used up, in motion before the answer would be late.
template <class Place>
bool is_region_due(const Place& held, const RegionWish& wish, double margin)
{
    return !held.covers(wish.point, wish.radius + 0.5 * std::max(margin, 0.0)) ||
           !held.covers(wish.point + wish.travel(), wish.radius);
}

}  // namespace shvr
