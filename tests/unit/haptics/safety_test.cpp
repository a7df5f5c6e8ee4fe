#include "haptics/safety.h"

#include <cmath>
#include <memory>

#include <doctest/doctest.h>

#include "haptics/force.h"
#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

constexpr uint64_t MILLISECOND = 1'000'000;

/// A hand over a tube along x: physical units are millimetres; fully engaged.
struct Held {
    ForceSettings settings{.assistance = true, .probe_radius = 2.5, .damping = 0.0};
    DeviceCaps caps{.outputs_force = true};
    std::unique_ptr<RelevancePatch> patch = std::make_unique<RelevancePatch>();
    std::unique_ptr<GrowthMemory> growth = std::make_unique<GrowthMemory>();
    ForceMemory memory;
    DeviceState state;
    uint64_t now_ns = 1'000'000'000;

    Held()
    {
        settings.workspace = {glm::dmat3(1000.0), glm::dvec3(8.0)};
        const Rod rod{.point = glm::dvec3(8.0), .radius = 1.0};
        fill_patch(*patch, {0, 0, 0}, glm::ivec3(64), glm::dvec3(0.25),
                   [&](const glm::dvec3& p) { return rod.holds(p); });
        patch->volume_size = glm::ivec3(64);
        run(1300);
        for (int i = 1; i <= 200; ++i) {
            state.position_m.y = 0.001 * i / 200.0;
            run(1);
        }
        run(100);
    }
    ForceStep run(int ticks, uint64_t tick_ns = MILLISECOND)
    {
        ForceStep now;
        for (int i = 0; i < ticks; ++i) {
            now_ns += tick_ns;
            state.time_ns = patch->time_ns = now_ns;
            ++state.sequence;
            now = step(settings, caps, ReadResult::fresh, state, *patch, now_ns, memory, *growth);
        }
        return now;
    }
    double force(int ticks = 1) { return glm::length(run(ticks).force_n); }
};

}  // namespace

TEST_CASE("a probe that is large in the hand pulls with less stiffness, and one that moves far does, too")
{
    const ForceSettings usual{.probe_radius = 2.5, .workspace = {glm::dmat3(1000.0), glm::dvec3(0.0)}};
    const DeviceCaps caps;
    CHECK(stiffness_at_hand(usual, caps, {}) == doctest::Approx(300.0));
    ForceSettings large = usual, zoomed = usual, far = usual, small = usual;
    large.probe_radius = 10.0;
    zoomed.workspace.to_volume = glm::dmat3(250.0);  // the same probe, four times as large in the hand
    far.movement_scale = 4.0;
    small.probe_radius = 0.5;
    for (const ForceSettings& settings : {large, zoomed, far})
        CHECK(stiffness_at_hand(settings, caps, {}) == doctest::Approx(75.0));
    CHECK(stiffness_at_hand(small, caps, {}) == doctest::Approx(400.0));  // what is clamped is felt by the hand
}

TEST_CASE("a late device gets less stiffness, whether it says so or is found out")
{
    const ForceSettings settings{.probe_radius = 0.1, .workspace = {glm::dmat3(1000.0), glm::dvec3(0.0)}};
    const double usual = stiffness_at_hand(settings, {.latency_s = 0.002}, {});
    const double stated = stiffness_at_hand(settings, {.latency_s = 0.008}, {});
    CHECK(usual == doctest::Approx(400.0));
    CHECK(stated < 0.4 * usual);
    SentForces sent;
    sent.latency_s = 0.008;
    CHECK(stiffness_at_hand(settings, {.latency_s = 0.002}, sent) == doctest::Approx(stated));
}

TEST_CASE("latency is measured by the numbers of forces")
{
    const DeviceCaps caps{.tells_force_sequence = true};
    SentForces sent;
    for (uint32_t tick = 1; tick <= 2000; ++tick) {
        const uint64_t now_ns = tick * MILLISECOND;
        const DeviceState state{.force_sequence = tick > 6 ? tick - 6 : 0};
        measure_latency(caps, state, now_ns, 0.001, sent);
        add_sent(glm::dvec3(0.0), now_ns, sent);
    }
    CHECK(sent.latency_s == doctest::Approx(0.005).epsilon(0.01));
}

TEST_CASE("however long a force is wanted, ten seconds of it never exceed what the motors can hold")
{
    const DeviceCaps caps;
    HeatMemory heat;
    std::vector<double> squares;
    for (int i = 0; i < 60'000; ++i) {
        const bool rests = i > 20'000 && i < 40'000;
        const double force = rests ? 0.0 : std::min(force_allowed(caps, heat), caps.peak_force_n);
        add_heat({force, 0.0, 0.0}, 0.001, heat);
        squares.push_back(force * force);
    }
    CHECK(squares.front() == doctest::Approx(3.3 * 3.3));
    CHECK(std::sqrt(squares.back()) == doctest::Approx(0.88 / std::sqrt(1.2)).epsilon(0.01));
    double window = 0.0, worst = 0.0;
    for (size_t i = 0; i < squares.size(); ++i) {
        window += squares[i] - (i >= 10'000 ? squares[i - 10'000] : 0.0);
        worst = std::max(worst, window / 10'000.0);
    }
    CHECK(std::sqrt(worst) <= caps.continuous_force_n);
}

TEST_CASE("fewer than 400 states a second halve the stiffness, fewer than 200 end the force")
{
    for (const auto& [tick_ms, share] : {std::pair(2.0, 1.0), {3.0, 0.5}, {6.0, 0.0}}) {
        Held held;
        const double full = held.force();
        REQUIRE(full > 0.2);
        const ForceStep slow = held.run(60, uint64_t(tick_ms * 1e6));
        CHECK(glm::length(slow.force_n) == doctest::Approx(share * full).epsilon(0.01));
        CHECK(((slow.flags & FORCE_SLOW) != 0) == (share < 1.0));
    }
}

TEST_CASE("let go: no force from that tick on, and afterwards it engages anew")
{
    Held held;
    REQUIRE(held.force() > 0.2);
    held.settings.let_go = true;
    const ForceStep now = held.run(1);
    CHECK(now.force_n == glm::dvec3(0.0));
    CHECK((now.flags & FORCE_LET_GO) != 0);
    held.settings.let_go = false;
    CHECK(held.force(50) < 0.05);
}

TEST_CASE("half of the strength is half of the force, and it gets there slowly")
{
    Held held;
    const double full = held.force();
    held.settings.strength = 0.5;
    CHECK(held.force() > 0.98 * full);
    CHECK(held.force(200) == doctest::Approx(0.5 * full));
    held.settings.strength = 0.0;
    CHECK(held.force(300) == 0.0);
}

TEST_CASE("outside the box in which a device's forces are right they fade out")
{
    Held held;
    const double full = held.force();
    held.caps.usable_upper_m.y = 0.001 - 0.5 * BOX_MARGIN_M;
    const ForceStep outside = held.run(100);
    CHECK(glm::length(outside.force_n) == doctest::Approx(0.5 * full));
    CHECK((outside.flags & FORCE_OUTSIDE) != 0);
    held.caps.usable_upper_m.y = 0.001 - 1.1 * BOX_MARGIN_M;
    CHECK(held.force(100) == 0.0);
}

TEST_CASE("another mode or law takes over without a step")
{
    Held held;
    double last = held.force();
    for (const ProxyLaw law : {ProxyLaw::mean, ProxyLaw::potential}) {
        held.settings.law = law;
        for (int i = 0; i < 150; ++i) {
            const double now = held.force();
            CHECK(std::abs(now - last) <= 0.02);
            last = now;
        }
    }
    held.settings.mode = TouchMode::surface;  // nothing holds here
    for (int i = 0; i < 120; ++i) {
        const double now = held.force();
        CHECK(std::abs(now - last) <= 0.02);
        last = now;
    }
    CHECK(last < 1e-9);
}

TEST_CASE("the observer sees energy made only where it is fed the force in effect")
{
    // A hand moves back and forth in a spring whose force comes three ticks late.
    EnergyMemory fed, commanded;
    std::vector<double> forces;
    double most_fed = 0.0, most_commanded = 0.0;
    for (int i = 0; i < 1000; ++i) {
        const double x = 0.005 * std::sin(0.03 * i), field = -300.0 * x;
        forces.push_back(field);
        const double effect = forces[size_t(std::max(i - 3, 0))];
        observe_energy({x, 0, 0}, {field, 0, 0}, {effect, 0, 0}, fed);
        observe_energy({x, 0, 0}, {field, 0, 0}, {field, 0, 0}, commanded);
        most_fed = std::max(most_fed, fed.made_j);
        most_commanded = std::max(most_commanded, commanded.made_j);
    }
    CHECK(most_fed > 10.0 * std::max(most_commanded, 1e-6));
    const double before = fed.made_j;
    const glm::dvec3 taken = take_energy({0.1, 0.0, 0.0}, 0.001, fed);
    CHECK(taken.x < 0.0);
    CHECK(glm::length(taken) <= TAKING_MOST_N);
    CHECK(fed.made_j < before);
}

TEST_CASE("limits that are no numbers allow nothing")
{
    Held held;
    held.caps.peak_force_n = std::nan("");
    CHECK(held.force(60) == 0.0);
    held.caps = {.stiffness_limit = std::nan(""), .outputs_force = true};
    CHECK(held.force(60) == 0.0);
}
