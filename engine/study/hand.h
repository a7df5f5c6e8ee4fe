#pragma once
// The model of an annotator's hand and eye: how far the hand strays from the place it aims at, and how precisely the
// eye locates that place. Lengths are in metres at the hand, where the shown volume is STUDY_REACH_M wide.
//
// `hand_traits()` gives the source of each value, or says that it is a guess. The study repeats its main comparison
// with each value halved and doubled, to check that no result depends on one value.
//
// One thread.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "engine/volume/split_mix.h"

namespace shvr {

/// Width of the shown volume at the hand: for 256 voxels, a voxel is 0.25 mm wide, as in tools/make_stylus_path.
inline constexpr double STUDY_REACH_M = 0.064;

struct HandTraits {
    double wander_m = 0.0015;     ///< amplitude of wandering along each axis, at 0.45 Hz
    double sway_m = 0.0007;       ///< amplitude of swaying along each axis, at 1.1 Hz
    double tremor_m = 0.00006;    ///< amplitude of tremor along each axis, at 9 Hz
    double rest_share = 0.3;      ///< share of wandering and swaying that remains when the hand holds still
    double lag_s = 0.2;           ///< time from seeing to acting
    double overshoot = 0.08;      ///< standard deviation of a reach's length, relative to the distance
    double lateral_m = 0.0003;    ///< standard deviation of the place seen, along each axis of the picture
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

/// Random numbers of a study, which are equal on every machine.
class StudyRandom {
public:
    explicit StudyRandom(uint64_t seed) : random_(seed) {}
    double unit();    ///< 0 <= result < 1
    double normal();  ///< normal distribution: mean 0, standard deviation 1, cut at +-6 (sum of twelve uniform numbers)
    bool happens(double probability) { return unit() < probability; }
    size_t below(size_t count) { return size_t(unit() * double(count)); }

private:
    SplitMix64 random_;
};

/// How a hand strays from the place it aims at: sines at three frequencies along three axes, with random phases.
class HandStray {
public:
    static constexpr double WANDER_HZ = 0.45, SWAY_HZ = 1.1, TREMOR_HZ = 9.0;

    HandStray(const HandTraits& traits, StudyRandom& random);
    /// Advances by `seconds`. `speed_m_per_s`: speed of the place aimed at; a moving hand strays more than one at rest.
    glm::dvec3 advance(double seconds, double speed_m_per_s);

private:
    HandTraits traits_;
    std::array<glm::dvec3, 3> phases_{};  ///< phases of wandering, swaying and tremor along each axis
    double time_s_ = 0.0;
    double motion_ = 0.0;  ///< 0 at rest ... 1 at the speed of a reach; a low-pass filtered speed
};

/// Share of the distance covered after a share of the time, in a minimum-jerk reach (Flash and Hogan 1985).
double share_of_way(double share_of_time);

}  // namespace shvr
