#include "haptics/servo.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "haptics/simulated_device.h"
#include "tests/support/haptic_scenes.h"
#include "tests/unit/haptics/allocations.h"

using namespace shvr;

namespace {

constexpr uint64_t MILLISECOND = 1'000'000;

/// Shared by a test and its servo's pacing.
struct Clock {
    std::atomic<bool> may_begin{false}, is_done{false}, may_end{false};
    uint64_t ticks = 0;                  ///< to run
    std::vector<uint64_t> oversleep_ns;  ///< by tick; 0 beyond its end
    std::vector<uint64_t> deadlines_ns;  ///< as requested; up to the capacity
    uint64_t allocations_seen = 0;

    /// Runs the ticks; the first one sees everything published before.
    void run()
    {
        may_begin = true;
        while (!is_done) std::this_thread::yield();
    }
};

/// Time that advances only by waiting: runs the requested ticks as fast as possible, then stops until the test releases
/// it.
class VirtualPacing : public Pacing {
public:
    explicit VirtualPacing(Clock& clock) : clock_(clock) {}
    uint64_t now_ns() noexcept override { return now_ns_; }
    void wait_until(uint64_t deadline_ns) noexcept override
    {
        while (!clock_.may_begin) std::this_thread::yield();
        if (tick_ == clock_.ticks) {
            clock_.allocations_seen = allocations;
            counts_allocations = false;
            clock_.is_done = true;
            while (!clock_.may_end) std::this_thread::yield();
        }
        if (clock_.deadlines_ns.size() < clock_.deadlines_ns.capacity()) clock_.deadlines_ns.push_back(deadline_ns);
        const uint64_t oversleep = tick_ < clock_.oversleep_ns.size() ? clock_.oversleep_ns[tick_] : 0;
        now_ns_ = std::max(now_ns_, deadline_ns) + oversleep;
        if (tick_++ == 0) counts_allocations = true;
    }

private:
    Clock& clock_;
    uint64_t now_ns_ = 1'000'000'000;
    uint64_t tick_ = 0;
};

/// Plays a script: lost between two ticks, otherwise at rest. Records the forces written.
class ScriptedDevice : public HapticDevice {
public:
    struct Script {
        glm::dvec3 position_m{0.0};
        uint64_t lost_from = ~uint64_t{0}, lost_to = ~uint64_t{0};  ///< reads
        bool write_fails_alone = false;                             ///< while lost, read() only says stale
        std::vector<glm::dvec3> forces_n;
    };
    explicit ScriptedDevice(Script& script) : script_(script) {}
    DeviceCaps caps() const noexcept override { return {.outputs_force = false}; }
    ReadResult read(DeviceState& state) noexcept override
    {
        ++reads_;
        if (is_lost()) return script_.write_fails_alone ? ReadResult::stale : ReadResult::lost;
        state = {};
        state.time_ns = reads_ * MILLISECOND;
        state.sequence = uint32_t(reads_);
        state.position_m = script_.position_m;
        return ReadResult::fresh;
    }
    bool write(const glm::dvec3& force_n, uint32_t) noexcept override
    {
        if (script_.forces_n.size() < script_.forces_n.capacity()) script_.forces_n.push_back(force_n);
        return !is_lost();
    }

private:
    bool is_lost() const { return reads_ >= script_.lost_from && reads_ < script_.lost_to; }
    Script& script_;
    uint64_t reads_ = 0;
};

constexpr Servo::Options VIRTUAL{.rate_hz = 1000, .realtime = false};

/// A rod along x, 0.4 mm from the hand.
ForceSettings settings_beside_rod()
{
    ForceSettings settings{.assistance = true, .probe_radius = 2.5};
    settings.workspace = {glm::dmat3(1000.0), glm::dvec3(8.0)};
    return settings;
}
void publish_rod(Latest<RelevancePatch>& relevance)
{
    RelevancePatch& patch = relevance.writing();
    const Rod rod{.point = {8.0, 8.4, 8.0}, .radius = 1.0};
    fill_patch(patch, {0, 0, 0}, {64, 64, 64}, glm::dvec3(0.25), [&](const glm::dvec3& p) { return rod.holds(p); });
    patch.volume_size = {64, 64, 64};
    patch.time_ns = ~uint64_t{0};  // never old
    relevance.publish();
}

}  // namespace

TEST_CASE("100,000 ticks run without an allocation, a late tick or a force that is no number")
{
    Clock clock;
    clock.ticks = 100'000;
    auto device = std::make_unique<SimulatedDevice>(MODELLED_HAND);
    Servo servo(std::move(device), std::make_unique<VirtualPacing>(clock), VIRTUAL);
    servo.settings().publish(settings_beside_rod());
    publish_rod(servo.relevance());
    clock.run();
    CHECK(clock.allocations_seen == 0);
    REQUIRE(servo.state().take());
    const ServoState& state = servo.state().value();
    CHECK(state.ticks == clock.ticks);
    CHECK(state.late_ticks == 0);
    CHECK(state.lateness.total() == clock.ticks);
    CHECK(state.duration.total() == clock.ticks);
    CHECK(state.lateness.worst_ns == 0);
    CHECK(state.device.sequence == clock.ticks);
    CHECK(state.step.flags == 0);
    CHECK(state.step.in_contact);
    CHECK(state.step.force_n.y > 0.01);
    clock.may_end = true;
}

TEST_CASE("the counter of allocations does count")
{
    counts_allocations = true;
    const uint64_t before = allocations;
    const auto something = std::make_unique<int>(1);
    counts_allocations = false;
    CHECK(allocations == before + 1);
    CHECK(*something == 1);
}

TEST_CASE(
    "a device of 4 kHz is served four times as often, without a late tick, and comes to rest where one of 1 kHz does")
{
    glm::dvec3 rest[2], force[2];
    for (const int i : {0, 1}) {
        const uint32_t rate_hz = i == 0 ? 1000 : 4000;
        Clock clock;
        clock.ticks = 3 * rate_hz;
        clock.deadlines_ns.reserve(clock.ticks);
        HandModel hand = MODELLED_HAND;
        hand.tick_s = 1.0 / rate_hz;
        Servo servo(std::make_unique<SimulatedDevice>(hand), std::make_unique<VirtualPacing>(clock),
                    {.rate_hz = rate_hz, .realtime = false});
        servo.settings().publish(settings_beside_rod());
        publish_rod(servo.relevance());
        clock.run();
        REQUIRE(servo.state().take());
        const ServoState& state = servo.state().value();
        CHECK(state.ticks == clock.ticks);
        CHECK(state.late_ticks == 0);
        CHECK(state.step.flags == 0);
        CHECK(clock.deadlines_ns.back() - clock.deadlines_ns.front() == (clock.ticks - 1) * (1'000'000'000 / rate_hz));
        rest[i] = state.device.position_m;
        force[i] = state.step.force_n;
        clock.may_end = true;
    }
    CHECK(glm::length(force[0]) > 0.02);
    CHECK(glm::distance(force[0], force[1]) < 0.01 * glm::length(force[0]));
    CHECK(glm::distance(rest[0], rest[1]) < 1e-6);
}

TEST_CASE("a lost device is commanded to zero within two ticks, and is felt again once it is back")
{
    for (const bool write_fails_alone : {false, true}) {
        CAPTURE(write_fails_alone);
        Clock clock;
        ScriptedDevice::Script script;
        script.write_fails_alone = write_fails_alone;
        script.lost_from = 10'000;
        script.lost_to = 12'000;
        script.forces_n.reserve(20'000);
        clock.ticks = 20'000;
        {
            Servo servo(std::make_unique<ScriptedDevice>(script), std::make_unique<VirtualPacing>(clock), VIRTUAL);
            servo.settings().publish(settings_beside_rod());
            publish_rod(servo.relevance());
            clock.run();
            clock.may_end = true;
        }
        REQUIRE(script.forces_n.size() >= 20'000);
        CHECK(script.forces_n[9'998].y > 0.05);  // the last read before the loss is number 9,999
        for (size_t i = 10'001; i < 11'999; ++i) REQUIRE(script.forces_n[i] == glm::dvec3(0.0));
        CHECK(script.forces_n[19'999].y == doctest::Approx(script.forces_n[9'998].y));
        CHECK(script.forces_n.size() == script.forces_n.capacity());
    }
}

TEST_CASE("the last thing a servo writes is a zero force")
{
    Clock clock;
    ScriptedDevice::Script script;
    script.forces_n.reserve(1'000'000);
    clock.ticks = 20'000;
    {
        Servo servo(std::make_unique<ScriptedDevice>(script), std::make_unique<VirtualPacing>(clock), VIRTUAL);
        servo.settings().publish(settings_beside_rod());
        publish_rod(servo.relevance());
        clock.run();
        REQUIRE(servo.state().take());
        CHECK(servo.state().value().step.force_n.y > 0.05);
        clock.may_end = true;
    }
    REQUIRE(script.forces_n.size() < script.forces_n.capacity());
    CHECK(script.forces_n.back() == glm::dvec3(0.0));
}

TEST_CASE("late ticks are counted, and their deadlines are skipped instead of bunched up")
{
    Clock clock;
    clock.ticks = 8;
    clock.deadlines_ns.reserve(8);
    // Half a period is not late; 1 period and a bit, and 3.5 periods, are.
    clock.oversleep_ns = {0, MILLISECOND / 2, 0, 1'200'000, 0, 3'500'000, 0, 0};
    ScriptedDevice::Script script;
    Servo servo(std::make_unique<ScriptedDevice>(script), std::make_unique<VirtualPacing>(clock), VIRTUAL);
    clock.run();
    std::vector<double> gaps_ms;
    for (size_t i = 1; i < clock.deadlines_ns.size(); ++i)
        gaps_ms.push_back(double(clock.deadlines_ns[i] - clock.deadlines_ns[i - 1]) / double(MILLISECOND));
    CHECK(gaps_ms == std::vector<double>{1, 1, 1, 2, 1, 4, 1});
    REQUIRE(servo.state().take());
    const ServoState& state = servo.state().value();
    CHECK(state.ticks == 8);
    CHECK(state.late_ticks == 2);
    CHECK(state.lateness.worst_ns == 3'500'000);
    clock.may_end = true;
}

TEST_CASE("a fault stays until the settings ask for a reset")
{
    Clock clock;
    clock.ticks = 10;
    ScriptedDevice::Script script;
    script.position_m = glm::dvec3(std::nan(""));
    auto pacing = std::make_unique<VirtualPacing>(clock);
    Servo servo(std::make_unique<ScriptedDevice>(script), std::move(pacing), VIRTUAL);
    clock.run();
    REQUIRE(servo.state().take());
    CHECK((servo.state().value().step.flags & FORCE_FAULT) != 0);
    // The servo is blocked in wait_until and does not touch the script.
    script.position_m = glm::dvec3(0.0);
    clock.may_end = true;
    const auto flags_after = [&](uint64_t more) {
        for (uint64_t seen = 0; seen < more;) {
            if (servo.state().take()) ++seen;
        }
        return servo.state().value().step.flags;
    };
    CHECK((flags_after(20) & FORCE_FAULT) != 0);
    servo.settings().publish({.reset = 1});
    uint32_t flags = FORCE_FAULT;
    for (int i = 0; i < 1'000'000 && (flags & FORCE_FAULT); ++i) flags = flags_after(1);
    CHECK((flags & FORCE_FAULT) == 0);
}

TEST_CASE("a histogram counts by powers of two of a microsecond")
{
    TimeHistogram histogram;
    CHECK(histogram.quantile_us(0.5) == 0.0);
    for (const uint64_t nanoseconds : {0u, 999u, 1000u, 1999u, 2000u, 3999u, 4000u, 100'000u})
        histogram.add(nanoseconds);
    CHECK(histogram.total() == 8);
    CHECK(histogram.counts[0] == 2);
    CHECK(histogram.counts[1] == 2);
    CHECK(histogram.counts[2] == 2);
    CHECK(histogram.counts[3] == 1);
    CHECK(histogram.counts[7] == 1);  // 64 to 128 us
    CHECK(histogram.worst_ns == 100'000);
    CHECK(histogram.quantile_us(0.25) == 1.0);
    CHECK(histogram.quantile_us(0.5) == 2.0);
    CHECK(histogram.quantile_us(1.0) == 128.0);
    histogram.add(60'000'000'000);
    CHECK(histogram.counts[TimeHistogram::BINS - 1] == 1);
    CHECK(histogram.quantile_us(1.0) == 60e6);
}

TEST_CASE("real pacing wakes no earlier than asked, and at once for what is past")
{
    const std::unique_ptr<Pacing> pacing = real_pacing();
    const uint64_t start_ns = pacing->now_ns();
    pacing->wait_until(start_ns + 3 * MILLISECOND);
    CHECK(pacing->now_ns() >= start_ns + 3 * MILLISECOND);
    pacing->wait_until(0);
    CHECK(pacing->now_ns() >= start_ns);
}

TEST_CASE("a servo on the real clock ticks, and says how long its ticks take")
{
    auto device = std::make_unique<SimulatedDevice>(MODELLED_HAND);
    Servo servo(std::move(device), real_pacing(), {.rate_hz = 1000, .realtime = true});
    servo.settings().publish(settings_beside_rod());
    publish_rod(servo.relevance());
    // A slow machine may tick late or skip ticks, but it does tick.
    while (!servo.state().take() || servo.state().value().ticks < 300)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const ServoState& state = servo.state().value();
    CHECK(state.lateness.total() == state.ticks);
    CHECK(state.relevance_age.total() > 0);
    MESSAGE("of ", state.ticks, " ticks: work p50 ", state.duration.quantile_us(0.5), " us, p99 ",
            state.duration.quantile_us(0.99), " us; lateness p50 ", state.lateness.quantile_us(0.5), " us, p99 ",
            state.lateness.quantile_us(0.99), " us; ", state.late_ticks, " late; ",
            std::string(servo.is_realtime() ? "" : "no "), "SCHED_FIFO");
}
