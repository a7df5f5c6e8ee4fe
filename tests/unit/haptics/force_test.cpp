#include "haptics/force.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

constexpr uint64_t MILLISECOND = 1'000'000;

/// One hand over a rod along x in a patch of 64 voxels of 0.25 mm: physical units are millimetres. Time is counted.
struct Bench {
    ForceSettings settings;
    DeviceCaps caps;
    RelevancePatch patch;
    ForceMemory memory;
    std::unique_ptr<GrowthMemory> growth = std::make_unique<GrowthMemory>();
    DeviceState state;
    uint64_t now_ns = 1'000'000'000, tick_ns = MILLISECOND;
    bool is_patch_renewed = true;  ///< as if the compute pass kept pace

    Bench()
    {
        settings.assistance = true;
        settings.probe_radius = 2.5;
        settings.damping = 0.0;
        settings.workspace.to_volume = glm::dmat3(1000.0);
        settings.workspace.origin = glm::dvec3(8.0);
        const Rod rod{.point = glm::dvec3(8.0), .radius = 1.0};
        fill_patch(patch, {0, 0, 0}, {64, 64, 64}, glm::dvec3(0.25), [&](const glm::dvec3& p) { return rod.holds(p); });
        patch.volume_size = {1000, 1000, 1000};
        patch.time_ns = now_ns;
        caps.outputs_force = true;
    }
    ForceStep tick(ReadResult result = ReadResult::fresh)
    {
        now_ns += tick_ns;
        if (result == ReadResult::fresh) state.time_ns += tick_ns;
        if (is_patch_renewed) patch.time_ns = now_ns;
        return step(settings, caps, result, state, patch, now_ns, memory, *growth);
    }
    ForceStep tick_at(const glm::dvec3& position_m)
    {
        state.position_m = position_m;
        return tick();
    }
    ForceStep run(int ticks)
    {
        ForceStep last;
        for (int i = 0; i < ticks; ++i) last = tick();
        return last;
    }
    /// Fully engages, then rests at distance `y_m` from the rod's middle.
    ForceStep settle(double y_m)
    {
        state.position_m = glm::dvec3(0.0);
        run(1300);
        for (int i = 1; i <= 200; ++i) tick_at({0.0, y_m * i / 200.0, 0.0});
        return run(100);
    }
};

}  // namespace

TEST_CASE("the force is stiffness times the proxy's offset, towards the rod")
{
    Bench bench;
    const ForceStep now = bench.settle(0.001);
    CHECK(now.flags == 0);
    CHECK(now.in_contact);
    const Proxy proxy = find_proxy(bench.patch, now.probe, 2.5, ProxyLaw::potential);
    CHECK(glm::distance(now.probe, glm::dvec3(8.0, 9.0, 8.0)) < 1e-9);
    CHECK(now.force_n.y == doctest::Approx(300.0 * proxy.offset.y * 1e-3));
    CHECK(now.force_n.y < -0.1);
    CHECK(std::abs(now.force_n.x) < 0.01);
    CHECK(glm::distance(now.proxy, now.probe + proxy.offset) < 1e-12);
}

TEST_CASE("the force is turned into the device's frame and does not depend on the workspace's scale")
{
    Bench plain, turned;
    const glm::dmat3 rotation(glm::rotate(glm::dmat4(1.0), 1.1, glm::normalize(glm::dvec3(1, -2, 3))));
    turned.settings.workspace.to_volume = rotation * 1000.0;
    const ForceStep straight = plain.settle(0.001);
    turned.settle(0.0);
    ForceStep now;
    for (int i = 1; i <= 300; ++i) {
        now = turned.tick_at(glm::transpose(rotation) * glm::dvec3(0.0, 0.001 * std::min(i, 200) / 200.0, 0.0));
    }
    CHECK(glm::distance(rotation * now.force_n, straight.force_n) < 1e-6);

    // The same scene ten times as large, moving ten times as far for the same motion of the hand.
    Bench large;
    large.patch.spacing *= 10.0;
    large.settings.probe_radius *= 10.0;
    large.settings.workspace = {glm::dmat3(10'000.0), glm::dvec3(80.0)};
    CHECK(glm::distance(large.settle(0.001).force_n, straight.force_n) < 1e-6);
}

TEST_CASE("stiffness and damping never exceed what is stable")
{
    Bench bench;
    const double at_limit = [&] {
        bench.settings.stiffness = bench.caps.stiffness_limit;
        return bench.settle(0.0005).force_n.y;
    }();
    bench.settings.stiffness = 5000.0;
    CHECK(bench.run(100).force_n.y == doctest::Approx(at_limit));
    bench.settings.stiffness = -10.0;
    CHECK(glm::length(bench.run(100).force_n) < 1e-12);
}

TEST_CASE("damping at the same motion is the same at 500, 1000 and 2000 Hz")
{
    std::array<double, 3> strengths{};
    for (size_t i = 0; i < 3; ++i) {
        const uint64_t rate = std::array<uint64_t, 3>{500, 1000, 2000}[i];
        Bench bench;
        bench.tick_ns = 1'000'000'000 / rate;
        bench.settings.stiffness = 0.0;
        bench.settings.damping = 1.0;
        // Along the rod, 4 mm to either side, six times a second.
        double sum = 0.0;
        for (uint64_t tick = 0; tick < 4 * rate; ++tick) {
            const double angle = 2.0 * std::numbers::pi * 6.0 * double(tick) / double(rate);
            const ForceStep now = bench.tick_at({0.004 * std::sin(angle), 0.0, 0.0});
            if (tick >= 2 * rate) sum += now.force_n.x * now.force_n.x / double(2 * rate);
        }
        strengths[i] = std::sqrt(sum);
    }
    const double expected = 0.004 * 2.0 * std::numbers::pi * 6.0 / std::sqrt(2.0);
    MESSAGE("RMS damping, N, at 500, 1000, 2000 Hz: ", strengths[0], " ", strengths[1], " ", strengths[2]);
    for (const double strength : strengths) {
        CHECK(strength == doctest::Approx(strengths[1]).epsilon(0.02));
        CHECK(strength == doctest::Approx(expected).epsilon(0.02));
    }
}

TEST_CASE("damping only acts in contact and with assistance")
{
    Bench bench;
    bench.settings.damping = 1.0;
    bench.settle(0.0);
    for (int i = 1; i <= 100; ++i) bench.tick_at({1e-5 * i, 0.0, 0.0});
    CHECK(bench.tick_at({0.00101, 0.0, 0.0}).force_n.x < -0.005);
    bench.patch.words.fill(0);
    ForceStep now;
    for (int i = 102; i <= 200; ++i) now = bench.tick_at({1e-5 * i, 0.0, 0.0});
    CHECK(glm::length(now.force_n) == 0.0);
}

TEST_CASE("no force acts while assistance is off, and switching it off fades within the slew limit")
{
    Bench bench;
    const double held = glm::length(bench.settle(0.002).force_n);
    REQUIRE(held > 2.0 * SLEW_N);
    bench.settings.assistance = false;
    double last = held;
    for (int i = 0; i < 60; ++i) {
        const double force = glm::length(bench.tick().force_n);
        CHECK(last - force <= SLEW_N + 1e-12);
        last = force;
    }
    CHECK(last == 0.0);
}

TEST_CASE("a device with motors engages within a second, and only once little is wanted")
{
    Bench bench;
    bench.state.position_m = {0.0, 0.0015, 0.0};  // a strong pull from the start
    CHECK(glm::length(bench.run(2000).force_n) == 0.0);
    CHECK((bench.run(1).flags & FORCE_ENGAGING) != 0);
    bench.state.position_m.y = 0.0;
    bench.run(500);
    CHECK(bench.memory.engagement == doctest::Approx(0.5).epsilon(0.01));
    CHECK((bench.run(1).flags & FORCE_ENGAGING) != 0);
    CHECK((bench.run(520).flags & FORCE_ENGAGING) == 0);
    CHECK(bench.memory.engagement == 1.0);
}

TEST_CASE("a device without motors engages at once, within a tenth of a second")
{
    Bench bench;
    bench.caps.outputs_force = false;
    bench.state.position_m = {0.0, 0.0015, 0.0};
    CHECK((bench.run(98).flags & FORCE_ENGAGING) != 0);
    const ForceStep now = bench.run(40);
    CHECK((now.flags & FORCE_ENGAGING) == 0);
    CHECK(now.force_n.y < -0.2);
}

TEST_CASE("a click against the hand's way marks where contact begins, in proportion to its speed, and slows it")
{
    // Differences of the force with clicks from that without, while the hand follows a path across the rod.
    const auto clicks_of = [](const std::vector<double>& path, bool has_motors) {
        Bench with, without;
        with.settings.clicks = true;
        std::vector<double> difference;
        for (Bench* bench : {&with, &without}) {
            bench->caps.outputs_force = has_motors;
            bench->state.position_m = {0.0, path.front(), 0.0};
            bench->run(1300);
        }
        for (const double y : path) {
            const ForceStep one = with.tick_at({0.0, y, 0.0}), other = without.tick_at({0.0, y, 0.0});
            CHECK(std::abs(one.force_n.x - other.force_n.x) < 1e-12);
            difference.push_back(one.force_n.y - other.force_n.y);
        }
        return difference;
    };
    const auto way = [](std::initializer_list<double> turns, double speed) {  // metres, with ticks of a millisecond
        std::vector<double> path{*turns.begin()};
        for (const double to : turns)
            while (std::abs(to - path.back()) > 1e-9)
                path.push_back(path.back() + std::clamp(to - path.back(), -speed * 1e-3, speed * 1e-3));
        return path;
    };
    const auto count = [](const std::vector<double>& difference) {
        int clicks = 0;
        for (size_t i = 1; i < difference.size(); ++i) clicks += difference[i] > 0.02 && difference[i - 1] <= 0.02;
        return clicks;
    };
    const std::vector<double> once = clicks_of(way({0.005, 0.002}, 0.05), true);
    CHECK(count(once) == 1);
    double impulse = 0.0;
    for (const double force : once) {
        CHECK(force >= -1e-12);  // against the way, which is downwards
        impulse += force * 1e-3;
    }
    CHECK(*std::ranges::max_element(once) == doctest::Approx(0.5 * CLICK_N).epsilon(0.03));
    CHECK(impulse == doctest::Approx(0.5 * CLICK_N * 0.016 * 2.0 / std::numbers::pi).epsilon(0.03));
    CHECK(count(clicks_of(way({0.005, 0.002}, 0.005), true)) == 0);
    CHECK(count(clicks_of(way({0.005, 0.002}, 0.05), false)) == 0);
    // Off for 40 ms is a hand that trembles; off for 200 ms, one that comes back. Where it turns round within a click,
    // what that gives it is taken back.
    CHECK(count(clicks_of(way({0.005, 0.003, 0.0045, 0.003}, 0.05), true)) == 1);
    std::vector<double> back = way({0.005, 0.003, 0.005}, 0.05);
    back.insert(back.end(), 200, back.back());
    for (const double y : way({0.005, 0.003}, 0.05)) back.push_back(y);
    CHECK(count(clicks_of(back, true)) == 2);
}

TEST_CASE("a lost device has no force the same tick, and engages anew when it is found")
{
    Bench bench;
    REQUIRE(glm::length(bench.settle(0.002).force_n) > 2.0 * SLEW_N);
    const ForceStep now = bench.tick(ReadResult::lost);
    CHECK(now.force_n == glm::dvec3(0.0));
    CHECK(now.flags == FORCE_NO_DEVICE);
    CHECK(bench.tick(ReadResult::stale).force_n == glm::dvec3(0.0));
    CHECK((bench.memory.flags & FORCE_NO_DEVICE) != 0);
    bench.state.position_m.y = 0.03;  // no glitch: the hand had time to move
    bench.tick();
    CHECK(bench.memory.has_last);
    CHECK(bench.memory.engagement < 0.01);
}

TEST_CASE("a device that falls silent, or is not calibrated, is let go within the slew limit")
{
    for (const bool is_silent : {true, false}) {
        Bench bench;
        double last = glm::length(bench.settle(0.002).force_n);
        bench.state.calibrated = is_silent;
        for (int i = 0; i < 100; ++i) {
            const double force = glm::length(bench.tick(is_silent ? ReadResult::stale : ReadResult::fresh).force_n);
            CHECK(last - force <= SLEW_N + 1e-12);
            last = force;
        }
        CHECK(last == 0.0);
        CHECK((bench.memory.flags & FORCE_NO_DEVICE) != 0);
    }
}

TEST_CASE("a state that is no place stops the force the same tick and latches the fault")
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, infinity, -infinity, 1e30, -1e308}) {
        for (const int place : {0, 1, 2, 3}) {
            Bench bench;
            bench.settle(0.002);
            const DeviceState good = bench.state;
            if (place < 3) bench.state.position_m[place] = bad;
            if (place == 3) bench.state.rotation.x = std::isfinite(bad) ? nan : bad;
            const ForceStep now = bench.tick();
            CHECK(now.force_n == glm::dvec3(0.0));
            CHECK((now.flags & FORCE_FAULT) != 0);
            CHECK(std::isfinite(now.probe.x + now.probe.y + now.probe.z));
            bench.state = good;
            CHECK(bench.run(50).force_n == glm::dvec3(0.0));
            CHECK((bench.memory.flags & FORCE_FAULT) != 0);
            bench.memory = {};
            CHECK((bench.run(1).flags & FORCE_FAULT) == 0);
        }
    }
}

TEST_CASE("settings that are no numbers never reach the hand")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (int which = 0; which < 5; ++which) {
        Bench bench;
        bench.settle(0.002);
        if (which == 0) bench.settings.stiffness = nan;
        if (which == 1) bench.settings.damping = nan;
        if (which == 2) bench.settings.workspace.origin.z = nan;
        if (which == 3) bench.settings.workspace.to_volume = glm::dmat3(nan);
        if (which == 4) bench.settings.probe_radius = nan;
        for (int i = 0; i < 100; ++i) {
            const ForceStep now = bench.tick();
            REQUIRE(std::isfinite(now.force_n.x + now.force_n.y + now.force_n.z));
            REQUIRE(std::isfinite(now.proxy.x + now.proxy.y + now.proxy.z));
        }
        CHECK(glm::length(bench.tick().force_n) < 1e-12);
    }
}

TEST_CASE("a single glitch changes nothing")
{
    Bench bench, undisturbed;
    bench.settings.damping = undisturbed.settings.damping = 1.0;
    bench.settle(0.001);
    undisturbed.settle(0.001);
    const DeviceState good = bench.state;
    bench.state.position_m.x += 0.006;
    const ForceStep glitched = bench.tick(), expected = undisturbed.tick();
    CHECK(glitched.force_n == expected.force_n);
    CHECK((glitched.flags & FORCE_FAULT) == 0);
    bench.state.position_m = good.position_m;
    CHECK(glm::distance(bench.tick().force_n, undisturbed.tick().force_n) < 1e-6);
}

TEST_CASE("glitches at different places are never believed; three at one place are, with the engagement at 0")
{
    Bench bench;
    bench.settle(0.001);
    for (int i = 0; i < 30; ++i) bench.tick_at({i % 2 == 0 ? 0.05 : -0.05, 0.0, 0.0});
    CHECK(bench.memory.last.position_m.x == 0.0);
    CHECK(bench.memory.engagement == 1.0);
    bench.tick_at({0.0, 0.04, 0.0});
    bench.tick_at({0.0, 0.0401, 0.0});
    CHECK(bench.memory.last.position_m.y == doctest::Approx(0.001));
    const ForceStep now = bench.tick_at({0.0, 0.0402, 0.0});
    CHECK(bench.memory.last.position_m.y == doctest::Approx(0.0402));
    CHECK(bench.memory.velocity == glm::dvec3(0.0));
    CHECK(bench.memory.engagement < 0.01);
    CHECK((now.flags & FORCE_FAULT) == 0);
}

TEST_CASE("a jump that the device tells of is believed at once and engages anew")
{
    Bench bench;
    bench.settle(0.001);
    bench.state.jump += 1;
    const ForceStep now = bench.tick_at({0.0, 0.04, 0.0});
    CHECK(now.probe.y == doctest::Approx(48.0));
    CHECK(bench.memory.engagement < 0.01);
    CHECK((now.flags & FORCE_FAULT) == 0);
}

TEST_CASE("time that stands still or goes back gives no velocity")
{
    Bench bench;
    bench.settings.damping = 1.0;
    bench.settle(0.0);
    bench.state.time_ns = 5 * MILLISECOND;
    bench.tick();
    bench.state.time_ns = 3 * MILLISECOND;  // tick() adds one
    bench.state.position_m.x = 0.001;
    const ForceStep now = bench.tick();
    CHECK(std::abs(now.force_n.x) < 0.01);
    CHECK((now.flags & FORCE_FAULT) == 0);
}

TEST_CASE("old relevance fades out over a tenth of a second, fades in at the same rate, and never jumps")
{
    Bench bench;
    const double full = glm::length(bench.settle(0.001).force_n);
    bench.is_patch_renewed = false;
    CHECK(glm::length(bench.run(10).force_n) == doctest::Approx(full));  // no effect for up to 10 ms
    CHECK(glm::length(bench.run(39).force_n) == doctest::Approx(full));
    double last = full;
    for (int i = 0; i < 102; ++i) {
        const double force = glm::length(bench.tick().force_n);
        CHECK(last - force <= full / 100.0 * 1.01);
        last = force;
    }
    CHECK(last == 0.0);
    CHECK((bench.memory.flags & FORCE_NO_REGION) != 0);
    bench.is_patch_renewed = true;
    for (int i = 0; i < 102; ++i) {
        const double force = glm::length(bench.tick().force_n);
        CHECK(force - last <= full / 100.0 * 1.01);
        last = force;
    }
    CHECK(last == doctest::Approx(full));
}

TEST_CASE("relevance that is unknown or covers less than half of the ball fades out as well")
{
    for (const bool is_unknown : {true, false}) {
        Bench bench;
        const double full = glm::length(bench.settle(0.001).force_n);
        if (is_unknown)
            bench.patch.sequence = 0;
        else
            bench.settings.probe_radius = 24.0;  // y from 0 to 16 is covered; up to 33 is not
        double last = full;
        for (int i = 0; i < 110; ++i) {
            const double force = glm::length(bench.tick().force_n);
            CHECK(last - force <= SLEW_N + 1e-12);
            last = force;
        }
        CHECK(last == 0.0);
        CHECK((bench.memory.flags & FORCE_NO_REGION) != 0);
    }
}

TEST_CASE("changing the probe's size fourfold in contact changes the force within the slew limit and keeps its sign")
{
    Bench bench;
    glm::dvec3 last = bench.settle(0.0008).force_n;
    for (const double radius : {2.5 / 4.0, 2.5 * 2.0, 2.5}) {
        bench.settings.probe_radius = radius;
        for (int i = 0; i < 60; ++i) {
            const glm::dvec3 force = bench.tick().force_n;
            CHECK(glm::distance(force, last) <= SLEW_N + 1e-12);
            CHECK(force.y <= 1e-9);
            last = force;
        }
    }
}

TEST_CASE("no force exceeds the peak, and clamping keeps its direction")
{
    Bench bench;
    bench.caps.peak_force_n = 0.15;
    const ForceStep now = bench.settle(0.001);
    CHECK(glm::length(now.force_n) == doctest::Approx(0.15));
    CHECK((now.flags & FORCE_CLAMPED) != 0);
    const Proxy proxy = find_proxy(bench.patch, now.probe, 2.5, ProxyLaw::potential);
    CHECK(glm::distance(glm::normalize(now.force_n), glm::normalize(proxy.offset)) < 1e-6);
}

TEST_CASE("60,000 ticks of nonsense: every force is a number, within the peak and within the slew limit")
{
    std::mt19937 random(21);
    Bench bench;
    bench.patch.words.fill(0x00ff00ffu);
    bench.settings.damping = 1.0;
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    glm::dvec3 last(0.0);
    int moved = 0;
    for (int i = 0; i < 60'000; ++i) {
        const auto dice = random() % 1000;
        ReadResult result = ReadResult::fresh;
        if (dice < 990) {
            bench.state.position_m += 0.0003 * glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            if (glm::length(bench.state.position_m) > 0.008) bench.state.position_m *= 0.5;
        } else if (dice == 990) {
            result = ReadResult::lost;
        } else if (dice == 991) {
            bench.state.position_m.x = random() % 2 ? 1e30 : std::numeric_limits<double>::quiet_NaN();
        } else if (dice < 995) {
            result = random() % 2 ? ReadResult::stale : ReadResult::malformed;
        } else if (dice == 995) {
            bench.state.time_ns = random();
        } else if (dice == 996) {
            bench.now_ns += uint64_t(random() % 1'000'000'000);
        } else if (dice == 997) {
            bench.settings.assistance = !bench.settings.assistance;
        } else if (dice == 998) {
            bench.settings.probe_radius = uniform(0.1, 4.0);
            bench.settings.law = random() % 2 ? ProxyLaw::mean : ProxyLaw::potential;
        } else {
            bench.caps.outputs_force = !bench.caps.outputs_force;
        }
        const ForceStep now = bench.tick(result);
        const double length = glm::length(now.force_n);
        REQUIRE(length <= bench.caps.peak_force_n * (1.0 + 1e-12));  // false for NaN
        const bool may_stop = (now.flags & (FORCE_FAULT | FORCE_NO_DEVICE)) != 0 && length == 0.0;
        if (!may_stop) REQUIRE(glm::distance(now.force_n, last) <= SLEW_N + 1e-12);
        last = now.force_n;
        moved += length > 0.0 ? 1 : 0;
        if (now.flags & FORCE_FAULT) {
            bench.memory = {};
            bench.state.position_m = glm::dvec3(0.0);
        }
    }
    CHECK(moved > 5'000);
}

TEST_CASE("the same trace gives the same forces, bit for bit")
{
    const auto play = [] {
        std::mt19937 random(22);
        Bench bench;
        bench.settings.damping = 1.0;
        glm::dvec3 sum(0.0);
        for (int i = 0; i < 3000; ++i) {
            const double x = double(random() % 1000) * 1e-6, y = double(random() % 1000) * 1e-6;
            sum = sum * 1.001 + bench.tick_at({x, y, 0.0}).force_n;
        }
        return sum;
    };
    const glm::dvec3 once = play();
    CHECK(once != glm::dvec3(0.0));
    CHECK(once == play());
}
