// Estimates of the cost of work (engine/gpu/pass_costs.h, engine/live/pace.h).

#include <doctest/doctest.h>

#include "engine/gpu/pass_costs.h"
#include "engine/live/pace.h"

using namespace shvr;

TEST_CASE("a pass that never ran is taken for slow, one that did for what it took, and a wrong time is forgotten")
{
    constexpr uint64_t TILE = 128 * 128;
    gpu::PassCosts costs;
    CHECK(costs.ms("raycast", TILE, true) == doctest::Approx(gpu::MAX_SUBMISSION_MS / 4));
    CHECK(costs.ms("encode", TILE, false) == doctest::Approx(1.6384));
    costs.learn("raycast", 10 * TILE, 5.0);
    CHECK(costs.ms("raycast", TILE, true) == doctest::Approx(0.5));
    CHECK(costs.ms("other", TILE, true) == doctest::Approx(gpu::MAX_SUBMISSION_MS / 4));
    costs.learn("raycast", TILE, 5.0);  // ten times as long: believed at once
    CHECK(costs.ms("raycast", TILE, true) == doctest::Approx(5.0));
    for (int pass = 0; pass < 4; ++pass) costs.learn("raycast", TILE, 0.5);
    CHECK(costs.ms("raycast", TILE, true) == doctest::Approx(0.5));
}

TEST_CASE("a few threads tell how long one takes, not how many a device does at once")
{
    gpu::PassCosts costs;
    costs.learn("raycast", 64, 0.1);
    CHECK(costs.ms("raycast", 1920 * 1080, true) < gpu::MAX_SUBMISSION_MS);
    CHECK(costs.ms("raycast", 4096, true) == doctest::Approx(0.1));
}

TEST_CASE("a pace is the slowest of the last eight graphs")
{
    Pace pace(2.0);
    CHECK(pace.ms() == 2.0);
    pace.learn(10.0, 0.0);  // nothing was done
    CHECK(pace.ms() == 2.0);
    pace.learn(10.0, 100.0);
    CHECK(pace.ms() == doctest::Approx(0.1));  // what was assumed first does not matter any more
    pace.learn(100.0, 100.0);
    CHECK(pace.ms() == doctest::Approx(1.0));
    CHECK(pace.affords(5.0) == doctest::Approx(5.0));
    for (size_t graph = 1; graph < Pace::GRAPHS; ++graph) {
        pace.learn(10.0, 100.0);
        CHECK(pace.ms() == doctest::Approx(1.0));
    }
    pace.learn(10.0, 100.0);
    CHECK(pace.ms() == doctest::Approx(0.1));
    pace.learn(0.0, 100.0);  // no clock is that fine
    CHECK(pace.ms() > 0.0);
}
