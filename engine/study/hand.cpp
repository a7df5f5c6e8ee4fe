#include "engine/study/hand.h"

#include <algorithm>
#include <cmath>

#include "engine/volume/procedural/turns.h"

namespace shvr {

namespace {

constexpr HandTrait TRAITS[] = {
    {"wander", "m", &HandTraits::wander_m, "the modelled hand of haptics/PROOFS.md and tools/make_stylus_path"},
    {"sway", "m", &HandTraits::sway_m, "likewise"},
    {"tremor", "m", &HandTraits::tremor_m, "likewise; physiological tremor has 8 to 12 Hz (Elble and Koller 1990)"},
    {"rest_share", "1", &HandTraits::rest_share,
     "a guess: errors of motion grow with its speed (Schmidt et al. 1979; Harris and Wolpert 1998)"},
    {"lag", "s", &HandTraits::lag_s, "190 to 260 ms to use what is seen (Keele and Posner 1968)"},
    {"overshoot", "1", &HandTraits::overshoot,
     "5 to 10 % of the distance: first movements of aimed reaches (Meyer et al. 1988)"},
    {"lateral", "m", &HandTraits::lateral_m, "a guess: 2 pixels of 0.15 mm on the screen, shown at the hand's scale"},
    {"depth", "m", &HandTraits::depth_m,
     "three times the lateral error, a guess: depth is seen less exactly than direction (van Beers et al. 1998)"},
    {"speed", "m/s", &HandTraits::speed_m_per_s, "tools/make_stylus_path"},
};

constexpr double MOTION_S = 0.3;  ///< time constant with which a hand that stops moving becomes steady; a guess

}  // namespace

std::span<const HandTrait> hand_traits()
{
    return TRAITS;
}

double StudyRandom::unit()
{
    return double(random_.next() >> 11) * 0x1p-53;
}

double StudyRandom::normal()
{
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += unit();
    return sum;
}

HandStray::HandStray(const HandTraits& traits, StudyRandom& random) : traits_(traits)
{
    for (glm::dvec3& turns : phases_)
        for (int axis = 0; axis < 3; ++axis) turns[axis] = random.unit();
}

glm::dvec3 HandStray::advance(double seconds, double speed_m_per_s)
{
    time_s_ += seconds;
    const double wanted = std::min(speed_m_per_s / traits_.speed_m_per_s, 1.0);
    motion_ += (wanted - motion_) * std::min(seconds / MOTION_S, 1.0);
    const double share = traits_.rest_share + std::max(1.0 - traits_.rest_share, 0.0) * motion_;
    const auto swing = [&](size_t which, double hertz, double metres) {
        glm::dvec3 swung;
        for (int axis = 0; axis < 3; ++axis)
            swung[axis] = metres * direction_of(hertz * time_s_ + phases_[which][axis]).y;
        return swung;
    };
    return swing(0, WANDER_HZ, share * traits_.wander_m) + swing(1, SWAY_HZ, share * traits_.sway_m) +
           swing(2, TREMOR_HZ, traits_.tremor_m);
}

double share_of_way(double share_of_time)
{
    const double t = std::clamp(share_of_time, 0.0, 1.0);
    return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}

}  // namespace shvr
