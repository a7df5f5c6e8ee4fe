// The tap between the servo and its device, on a clock that the test moves.

#include "engine/workbench/touch/device_tap.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "engine/workbench/touch/device_watch.h"
#include "engine/workbench/touch/stylus_recorder.h"
#include "haptics/replay/replay.h"
#include "haptics/simulated_device.h"
#include "tests/support/haptic_scenes.h"
#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;
using namespace shvr::ui;

namespace {

/// Ticks run only as they are granted.
struct Grants {
    std::atomic<uint64_t> granted{0}, begun{0};
    std::atomic<bool> is_free{false};
};

class GrantedPacing : public Pacing {
public:
    explicit GrantedPacing(Grants& grants, uint64_t now_ns) : grants_(grants), now_ns_(now_ns) {}
    uint64_t now_ns() noexcept override { return now_ns_; }
    void wait_until(uint64_t deadline_ns) noexcept override
    {
        grants_.begun = tick_;
        while (tick_ >= grants_.granted && !grants_.is_free) std::this_thread::yield();
        ++tick_;
        now_ns_ = deadline_ns;
    }

private:
    Grants& grants_;
    uint64_t now_ns_, tick_ = 0;
};

struct Bench {
    Grants grants;
    std::shared_ptr<SimulatedDevice> device = std::make_shared<SimulatedDevice>(MODELLED_HAND);
    TappedServo tapped;
    TapOrder order;

    explicit Bench(uint64_t now_ns = 1'000'000'000) : tapped(device, std::make_unique<GrantedPacing>(grants, now_ns), 1)
    {
        order.settings.force = {.assistance = true, .probe_radius = 2.5};
        order.settings.force.workspace = {glm::dmat3(1000.0), glm::dvec3(8.0)};
    }
    ~Bench() { grants.is_free = true; }
    /// All of them are done when it returns.
    void run(uint64_t ticks)
    {
        grants.granted += ticks;
        while (grants.begun < grants.granted) std::this_thread::yield();
    }
    void send() { tapped.link->orders().publish(order); }
    void publish_rod()
    {
        make_rod(tapped.relevance());
        tapped.publish_relevance();
    }
    static void make_rod(RelevancePatch& patch)
    {
        const Rod rod{.point = {8.0, 8.4, 8.0}, .radius = 1.0};
        fill_patch(patch, {0, 0, 0}, {64, 64, 64}, glm::dvec3(0.25), [&](const glm::dvec3& p) { return rod.holds(p); });
        patch.volume_size = {64, 64, 64};
        patch.time_ns = uint64_t{1} << 60;  // never old
    }
};

}  // namespace

TEST_CASE("a recording of a hand replays bit for bit, through changes of what was chosen")
{
    Bench bench;
    StylusRecorder recorder("hand.trace", "mm", 1);
    bench.publish_rod();
    bench.order.recording = 1;
    bench.send();
    double largest = 0.0;
    const auto run = [&](uint64_t ticks) {
        for (uint64_t tick = 0; tick < ticks; tick += 50) {
            bench.device->wish().publish({.position_m = glm::dvec3(1e-5 * double(tick), 2e-6 * double(tick), 0.0),
                                          .buttons = uint32_t(tick / 50 % 2),
                                          .jump = 0});
            bench.run(50);
            recorder.advance(*bench.tapped.link);
            bench.tapped.servo.state().take();
            largest = std::max(largest, glm::length(bench.tapped.servo.state().value().step.force_n));
        }
    };
    run(1500);
    bench.order.settings.force.mode = TouchMode::object;
    bench.send();
    run(700);
    bench.order.settings.force.strength = 0.4;
    bench.order.settings.force.law = ProxyLaw::mean;
    bench.send();
    run(700);
    bench.order.settings.force.let_go = true;
    bench.send();
    run(100);
    CHECK(largest > 0.05);
    REQUIRE(recorder.end() == "");
    CHECK(recorder.seconds() == 3.0);

    TemporaryFolder folder;
    const std::filesystem::path file = folder.path / "hand.trace";
    write_trace(file, recorder.take());
    const Trace trace = read_trace(file);
    REQUIRE(trace.settings.size() == 4);
    CHECK(trace.settings[1].from_tick == 1500);
    CHECK(trace.settings[3].from_tick == 2900);
    const ReplayResult result = replay_trace(trace, {}, {});
    CHECK(result.told == 3000);
    CHECK(result.told_equal == 3000);
    CHECK(result.largest_force_n > 0.05);
}

TEST_CASE("a recording goes on through a swap of the device, and replays bit for bit on both sides of it")
{
    StylusRecorder recorder("hand.trace", "mm", 1);
    recorder.swap_device();  // the first device is none
    for (const bool is_second : {false, true}) {
        Bench bench(is_second ? 9'000'000'000 : 1'000'000'000);
        if (is_second) recorder.swap_device();
        bench.order.recording = 1;
        bench.order.settings.force.mode = is_second ? TouchMode::proximity : TouchMode::object;
        bench.publish_rod();
        if (is_second) bench.run(20);  // a servo that was told nothing yet
        bench.send();
        for (int i = 0; i < 40; ++i) {
            bench.device->wish().publish({.position_m = {1e-5 * i, 2e-6 * i, 0.0}, .buttons = 0, .jump = 0});
            bench.run(50);
            recorder.advance(*bench.tapped.link);
        }
        REQUIRE(recorder.end() == "");
    }
    const Trace trace = parse_trace(text_of(recorder.take()), "hand.trace");
    CHECK(trace.swaps == std::vector<size_t>{2000});
    REQUIRE(trace.relevance.size() == 2);
    CHECK(trace.relevance[1].sequence == trace.relevance[0].sequence);  // it counts from the start again
    const ReplayResult result = replay_trace(trace, {}, {});
    CHECK(result.told == 4020);
    CHECK(result.told_equal == 4020);
    CHECK(result.swaps == 1);
    CHECK(result.late == 0);
    CHECK(result.largest_force_n > 0.03);
    // Told of no swap, the same ticks give other forces.
    Trace unmarked = trace;
    unmarked.swaps.clear();
    CHECK_THROWS_AS(parse_trace(text_of(unmarked), "t"), Error);  // numbers of relevance go back
    unmarked.relevance.pop_back();
    CHECK(replay_trace(unmarked, {}, {}).told_equal < 4020);
}

TEST_CASE("a recording that is not fetched ends with a sentence, and the servo goes on")
{
    Bench bench;
    StylusRecorder recorder("hand.trace", "mm", 1);
    bench.order.recording = 1;
    bench.send();
    bench.run(5000);
    recorder.advance(*bench.tapped.link);
    CHECK(recorder.end().find("was not recorded") != std::string::npos);
    bench.tapped.servo.state().take();
    CHECK(bench.tapped.servo.state().value().ticks == 5000);
}

TEST_CASE("a probe that is held to a plane stays in it, and the hand feels nothing across it")
{
    Bench bench;
    bench.order.plane = {.is_on = true, .normal = {0.0, 0.6, 0.8}, .point_m = {0.0, 0.001, 0.0}, .count = 1};
    bench.order.recording = 1;
    bench.publish_rod();
    bench.send();
    bench.device->wish().publish({.position_m = {0.001, 0.0, 0.002}, .buttons = 0, .jump = 0});
    bench.run(1500);
    RecordedTick tick;
    double farthest = 0.0, moved = 0.0, force = 0.0;
    while (bench.tapped.link->take(tick)) {
        const glm::dvec3 away = tick.tick.state.position_m - bench.order.plane.point_m;
        farthest = std::max(farthest, std::abs(glm::dot(bench.order.plane.normal, away)));
        moved = std::max(moved, std::abs(away.x));
        force = std::max(force, glm::length(*tick.tick.force_n));
    }
    CHECK(farthest < 1e-15);
    CHECK(moved > 1e-4);
    CHECK(force > 0.01);
    // The force drew the hand along the plane alone: perpendicular to it the hand is where it wished to be.
    DeviceState raw;
    bench.device->read(raw);  // the servo waits for the next tick
    const glm::dvec3 drawn = raw.position_m - glm::dvec3(0.001, 0.0, 0.002);
    CHECK(std::abs(glm::dot(bench.order.plane.normal, drawn)) < 1e-6);
}

TEST_CASE("the plot holds the largest force of each fiftieth of a second, and the motors' heat")
{
    Bench bench;
    bench.publish_rod();
    bench.send();
    bench.run(3000);
    REQUIRE(bench.tapped.link->state().take());
    const TapState& tap = bench.tapped.link->state().value();
    CHECK(tap.bars == 150);
    bench.tapped.servo.state().take();
    const double now_n = glm::length(bench.tapped.servo.state().value().step.force_n);
    CHECK(double(tap.force_n[149]) == doctest::Approx(now_n).epsilon(0.1));
    CHECK(tap.heat > 0.0);
    CHECK(tap.heat < 1.0);
    CHECK(tap.lost_states == 0);
}

TEST_CASE("devices are looked for and opened on another thread, and failures are told in words")
{
    DeviceListing row;
    row.id = "fake:1";
    row.name = "A pen";
    DeviceWatch watch({.list = [&] { return std::vector<DeviceListing>{row}; },
                       .open = [](const std::string& id) -> std::unique_ptr<HapticDevice> {
                           if (id != "fake:1") fail(id, ": is not there");
                           return std::make_unique<SimulatedDevice>();
                       }});
    const auto wait = [&] {
        while (watch.is_busy()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return watch.take();
    };
    watch.look();
    const DeviceWatch::News seen = wait();
    REQUIRE(seen.devices);
    CHECK(seen.devices->at(0).name == "A pen");
    watch.open("fake:1");
    CHECK(wait().opened->device);
    watch.open("fake:2");
    const DeviceWatch::News refused = wait();
    CHECK(!refused.opened->device);
    CHECK(refused.opened->failure == "fake:2: is not there");
}
