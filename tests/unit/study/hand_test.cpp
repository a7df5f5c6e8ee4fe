// The modelled hand of a study: how far it strays at each frequency, and its random numbers.

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/study/hand.h"

using namespace shvr;

namespace {

constexpr double RATE = 1000.0;
constexpr int SECONDS = 20;  // whole periods of all three frequencies

std::vector<glm::dvec3> strays(const HandTraits& traits, double speed, uint64_t seed = 5)
{
    StudyRandom random(seed);
    HandStray stray(traits, random);
    for (int i = 0; i < int(5 * RATE); ++i) stray.advance(1.0 / RATE, speed);  // until it moves, or rests
    std::vector<glm::dvec3> path;
    for (int i = 0; i < int(SECONDS * RATE); ++i) path.push_back(stray.advance(1.0 / RATE, speed));
    return path;
}

/// The amplitude along an axis at a frequency.
double amplitude(const std::vector<glm::dvec3>& path, int axis, double hertz)
{
    double cosine = 0.0, sine = 0.0;
    for (size_t i = 0; i < path.size(); ++i) {
        const double angle = 2.0 * std::numbers::pi * hertz * double(i) / RATE;
        cosine += path[i][axis] * std::cos(angle) * 2.0 / double(path.size());
        sine += path[i][axis] * std::sin(angle) * 2.0 / double(path.size());
    }
    return std::hypot(cosine, sine);
}

}  // namespace

TEST_CASE("a moving hand strays by 1.5 mm at 0.45 Hz, 0.7 mm at 1.1 Hz and 0.06 mm at 9 Hz, and by nothing else")
{
    const HandTraits traits;
    const std::vector<glm::dvec3> path = strays(traits, traits.speed_m_per_s);
    for (int axis = 0; axis < 3; ++axis) {
        CAPTURE(axis);
        CHECK(amplitude(path, axis, HandStray::WANDER_HZ) == doctest::Approx(traits.wander_m).epsilon(0.01));
        CHECK(amplitude(path, axis, HandStray::SWAY_HZ) == doctest::Approx(traits.sway_m).epsilon(0.01));
        CHECK(amplitude(path, axis, HandStray::TREMOR_HZ) == doctest::Approx(traits.tremor_m).epsilon(0.01));
        double squares = 0.0;
        for (const glm::dvec3& at : path) squares += at[axis] * at[axis] / double(path.size());
        const double told =
            traits.wander_m * traits.wander_m + traits.sway_m * traits.sway_m + traits.tremor_m * traits.tremor_m;
        CHECK(std::sqrt(squares) == doctest::Approx(std::sqrt(0.5 * told)).epsilon(0.01));
    }
}

TEST_CASE("a hand that holds still wanders less, by the share that is stated, and trembles as much")
{
    const HandTraits traits;
    const std::vector<glm::dvec3> path = strays(traits, 0.0);
    CHECK(amplitude(path, 0, HandStray::WANDER_HZ) ==
          doctest::Approx(traits.rest_share * traits.wander_m).epsilon(0.01));
    CHECK(amplitude(path, 0, HandStray::TREMOR_HZ) == doctest::Approx(traits.tremor_m).epsilon(0.01));
}

TEST_CASE("hands of one seed stray alike, those of another differently")
{
    CHECK(strays({}, 0.02, 1) == strays({}, 0.02, 1));
    CHECK(strays({}, 0.02, 1) != strays({}, 0.02, 2));
}

TEST_CASE("random numbers of a study have the mean and the deviation that they state")
{
    StudyRandom random(9);
    constexpr int COUNT = 100'000;
    double sum = 0.0, squares = 0.0, units = 0.0;
    for (int i = 0; i < COUNT; ++i) {
        const double x = random.normal();
        sum += x / COUNT;
        squares += x * x / COUNT;
        units += random.unit() / COUNT;
    }
    CHECK(sum == doctest::Approx(0.0).epsilon(0.02));
    CHECK(squares == doctest::Approx(1.0).epsilon(0.02));
    CHECK(units == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("every trait of a hand is listed once, with its source")
{
    CHECK(hand_traits().size() * sizeof(double) == sizeof(HandTraits));
    for (const HandTrait& trait : hand_traits()) {
        CAPTURE(std::string(trait.name));
        CHECK(HandTraits{}.*trait.value > 0.0);
        CHECK(!trait.source.empty());
    }
}

TEST_CASE("a reach begins and ends at rest and covers half of the way in half of the time")
{
    CHECK(share_of_way(0.0) == 0.0);
    CHECK(share_of_way(0.5) == doctest::Approx(0.5));
    CHECK(share_of_way(1.0) == 1.0);
    CHECK(share_of_way(0.01) < 2e-5);
    CHECK(share_of_way(0.99) > 1.0 - 2e-5);
}
