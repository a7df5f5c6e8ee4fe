// Cost of a tick as a count: words that growing hands on, exactly. tests/cli/instruments/test_haptics_cost.py counts
// the instructions of step() while these cases run.

#include <cmath>
#include <memory>
#include <random>

#include <doctest/doctest.h>

#include "haptics/force.h"
#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

constexpr int TICKS = 20;  ///< test_haptics_cost.py divides by it

WindingLine line_in(int side)
{
    return {0.5 * side, 0.1 * side, 25.0, 0.08 * side, 30.0};
}

/// A winding tube of 4 voxels, one beside it, 1 % noise, as `shvr haptics bench` has them.
void fill_scene(int side, RelevancePatch& patch)
{
    std::mt19937 random(7);
    const WindingLine line = line_in(side);
    fill_patch(patch, {0, 0, 0}, glm::ivec3(side), glm::dvec3(1.0), [&](const glm::dvec3& p) {
        const glm::dvec3 away = p - line.at(p.x), other = away - glm::dvec3(0.0, 11.0, 3.0);
        const bool is_noise = random() % 100 == 0;
        return glm::dot(away, away) <= 25.0 || glm::dot(other, other) <= 16.0 || is_noise;
    });
    patch.volume_size = glm::ivec3(side);
    patch.time_ns = ~uint64_t{0};
}

/// Every tick has a new region: it carries the object over, grows it and integrates the ball.
void run_ticks(int side, double radius)
{
    const auto patch = std::make_unique<RelevancePatch>();
    fill_scene(side, *patch);
    const auto growth = std::make_unique<GrowthMemory>();
    ForceMemory memory;
    ForceSettings settings{.assistance = true, .probe_radius = radius};
    settings.mode = TouchMode::object;
    settings.workspace = {glm::dmat3(4000.0), line_in(side).at(0.5 * side)};
    DeviceState state;
    ForceStep now;
    for (int tick = 0; tick < TICKS; ++tick) {
        ++state.sequence;
        state.time_ns += 1'000'000;
        state.position_m.x += 2e-5;
        if (tick > 2) ++patch->sequence;  // once it has touched
        now = step(settings, {.outputs_force = true}, ReadResult::fresh, state, *patch, state.time_ns, memory, *growth);
    }
    CHECK(now.in_contact);
    CHECK(growth->contacts == 1);
}

uint32_t growth_steps(int side)
{
    const auto patch = std::make_unique<RelevancePatch>(), grown = std::make_unique<RelevancePatch>();
    const auto list = std::make_unique<GrowthList>();
    fill_scene(side, *patch);
    begin_growth(*patch, *grown, *list);
    REQUIRE(seed_nearest(*patch, line_in(side).at(0.5 * side), 12.0, *grown, *list));
    const uint32_t steps = grow(*patch, *grown, *list, ~0u);
    CHECK(list->count == 0);
    return steps;
}

}  // namespace

TEST_CASE("cost: 64^3 voxels and a ball of 12")
{
    run_ticks(64, 12.0);
}

TEST_CASE("cost: 64^3 voxels and a ball of 24")
{
    run_ticks(64, 24.0);
}

TEST_CASE("cost: 128^3 voxels and a ball of 48")
{
    run_ticks(128, 48.0);
}

TEST_CASE("tubes in 64^3 and 128^3 voxels grow within one tick: so many words are handed on, and no more")
{
    const uint32_t small = growth_steps(64), large = growth_steps(128);
    MESSAGE(small, " words in 64^3, ", large, " in 128^3");
    CHECK(small == 292);
    CHECK(large == 835);
    CHECK(large < GROWTH_STEPS);
}
