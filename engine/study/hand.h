#pragma once
// The model of an annotator's hand and eye: how far a hand strays from the place that it aims at, and how well an eye
// tells where that place is. Lengths are those of the hand, in metres; a study shows its volume STUDY_REACH_M wide.
//
// Each value has a source in `hand_traits()`; those without one are guesses, and say so. The study repeats its main
// comparison with each value halved and doubled, since no result should depend on them.
//
// One thread.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "engine/volume/split_mix.h"

namespace shvr {

/// Width in the hand of the shown volume: at 256 voxels a voxel is 0.25 mm, as in tools/make_stylus_path.
inline constexpr double STUDY_REACH_M = 0.064;

struct HandTraits {
    double wander_m = 0.0015;     ///< amplitude of wandering along each axis, at 0.45 Hz
    double sway_m = 0.0007;       ///< amplitude of swaying along each axis, at 1.1 Hz
    double tremor_m = 0.00006;    ///< amplitude of tremor along each axis, at 9 Hz
    double rest_share = 0.3;      ///< share of wandering and swaying that is left in a hand that holds still
    double lag_s = 0.2;           ///< time from seeing to acting
    double overshoot = 0.08;      ///< standard deviation of a reach's length, relative to its length
    double lateral_m = 0.0003;    ///< standard deviation of where the eye sees a place, along each axis of the picture
    double depth_m = 0.0009;      ///< likewise, along the line of sight
    double speed_m_per_s = 0.02;  ///< mean speed of a reach
};

struct HandTrait {
    std::string_view name;  ///< in files and reports
    std::string_view unit;
    double HandTraits::*value;
    std::string_view source;
};
/// All members of HandTraits, in their order.
std::span<const HandTrait> hand_traits();

/// Random numbers of a study: equal on every machine.
class StudyRandom {
public:
    explicit StudyRandom(uint64_t seed) : random_(seed) {}
    double unit();    ///< 0 <= result < 1
    double normal();  ///< mean 0, standard deviation 1, within +-6: the sum of twelve uniform numbers
    bool happens(double probability) { return unit() < probability; }
    size_t below(size_t count) { return size_t(unit() * double(count)); }

private:
    SplitMix64 random_;
};

/// How a hand strays from the place that it aims at: sines at three frequencies along three axes, with random phases.
class HandStray {
public:
    static constexpr double WANDER_HZ = 0.45, SWAY_HZ = 1.1, TREMOR_HZ = 9.0;

    HandStray(const HandTraits& traits, StudyRandom& random);
    /// Advances by `seconds`. `speed_m_per_s`: of the place aimed at; a hand that moves strays more.
    glm::dvec3 advance(double seconds, double speed_m_per_s);

private:
    HandTraits traits_;
    std::array<glm::dvec3, 3> phases_{};  ///< phases of wandering, swaying and tremor along each axis
    double time_s_ = 0.0;
    double motion_ = 0.0;  ///< 0 at rest ... 1 at a reach's speed; follows the speed slowly
};

/// Share of the way after a share of the time, of a reach with the least jerk (Flash and Hogan 1985).
double share_of_way(double share_of_time);

}  // namespace shvr
