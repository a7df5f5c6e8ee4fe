#include "haptics/hid/hid_device.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "haptics/hid/hid_link.h"
#include "haptics/servo.h"

using namespace shvr;
using std::chrono::milliseconds;

namespace {

using SteadyClock = std::chrono::steady_clock;
using Bytes = std::vector<uint8_t>;

/// The device behind a fake port. One lock guards all of it; the servo's side never takes it.
struct World {
    std::mutex mutex;
    std::condition_variable changed;
    bool is_plugged = true, writes_block = false;
    milliseconds write_time{0};
    std::deque<Bytes> incoming;
    std::vector<Bytes> written;
    Bytes feature;
    int opened = 1;

    template <class Change>
    void change(const Change& apply)
    {
        const std::lock_guard lock(mutex);
        apply();
        changed.notify_all();
    }
    std::vector<Bytes> all_written()
    {
        const std::lock_guard lock(mutex);
        return written;
    }
};

class FakePort : public HidPort {
public:
    explicit FakePort(World& world) : world_(world) {}
    int read(std::span<uint8_t> report, int timeout_ms) override
    {
        std::unique_lock lock(world_.mutex);
        world_.changed.wait_for(lock, milliseconds(timeout_ms),
                                [&] { return !world_.incoming.empty() || !world_.is_plugged; });
        if (!world_.is_plugged) return -1;
        if (world_.incoming.empty()) return 0;
        const Bytes bytes = std::move(world_.incoming.front());
        world_.incoming.pop_front();
        const size_t size = std::min(bytes.size(), report.size());
        std::copy_n(bytes.begin(), size, report.begin());
        return int(size);
    }
    bool write(std::span<const uint8_t> report) override
    {
        std::unique_lock lock(world_.mutex);
        world_.changed.wait(lock, [&] { return !world_.writes_block; });
        const milliseconds time = world_.write_time;
        lock.unlock();
        if (time.count() > 0) std::this_thread::sleep_for(time);
        lock.lock();
        if (!world_.is_plugged) return false;
        world_.written.emplace_back(report.begin(), report.end());
        return true;
    }
    int read_feature(uint8_t, std::span<uint8_t> report) override
    {
        const std::lock_guard lock(world_.mutex);
        std::copy(world_.feature.begin(), world_.feature.end(), report.begin());
        return int(world_.feature.size());
    }

private:
    World& world_;
};

HidProfile reference()
{
    return load_hid_profile("assets/devices/shvr_reference.json");
}

std::unique_ptr<HapticDevice> make_link(World& world, const HidProfile& profile, bool allow_force)
{
    const auto reopen = [&world]() -> std::unique_ptr<HidPort> {
        const std::lock_guard lock(world.mutex);
        if (!world.is_plugged) return nullptr;
        ++world.opened;
        return std::make_unique<FakePort>(world);
    };
    return make_hid_link(profile, std::make_unique<FakePort>(world), reopen, {.allow_force = allow_force});
}

/// Report 1 with a sequence, a time of as many milliseconds, and x in micrometres.
Bytes report_of(uint16_t sequence, int32_t x_um)
{
    Bytes bytes(33);
    bytes[0] = 1;
    bytes[2] = 1;
    const auto put = [&](size_t at, uint32_t value, size_t count) {
        for (size_t i = 0; i < count; ++i) bytes[at + i] = uint8_t(value >> (8 * i));
    };
    put(3, sequence, 2);
    put(5, uint32_t{sequence} * 1000, 4);
    put(9, uint32_t(x_um), 4);
    put(21, 0x7fff, 2);
    return bytes;
}

int force_x_mn(const Bytes& report)
{
    return int16_t(report.at(5) | report.at(6) << 8);
}
bool is_enabled(const Bytes& report)
{
    return report.at(1) & 1u;
}

/// Waits until the claim holds; false after two seconds, which no test should need.
template <class Claim>
bool comes_true(const Claim& claim)
{
    const SteadyClock::time_point end = SteadyClock::now() + std::chrono::seconds(30);
    while (SteadyClock::now() < end) {
        if (claim()) return true;
        std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
}

/// The next result that is not `stale`.
ReadResult next_result(HapticDevice& device, DeviceState& state)
{
    ReadResult result = ReadResult::stale;
    comes_true([&] { return (result = device.read(state)) != ReadResult::stale; });
    return result;
}

}  // namespace

TEST_CASE("a report is read once, in SI units")
{
    World world;
    const auto device = make_link(world, reference(), true);
    DeviceState state;
    CHECK(device->read(state) == ReadResult::stale);
    world.change([&] { world.incoming.push_back(report_of(7, -12'000)); });
    CHECK(next_result(*device, state) == ReadResult::fresh);
    CHECK(state.position_m.x == doctest::Approx(-0.012));
    CHECK(state.sequence == 7);
    CHECK(state.time_ns == 7'000'000);
    CHECK(state.calibrated);
    CHECK(device->read(state) == ReadResult::stale);
}

TEST_CASE("of a burst of 63 old reports the newest is what the servo gets in the end, and nothing goes back")
{
    World world;
    const auto device = make_link(world, reference(), true);
    world.change([&] {
        for (uint16_t i = 1; i <= 63; ++i) world.incoming.push_back(report_of(i, 100 * i));
    });
    DeviceState state;
    uint32_t last = 0;
    CHECK(comes_true([&] {
        if (device->read(state) == ReadResult::fresh) {
            CHECK(state.sequence > last);
            last = state.sequence;
        }
        return last == 63;
    }));
}

TEST_CASE("sequences and times go on where their counters overflow")
{
    World world;
    const auto device = make_link(world, reference(), true);
    DeviceState state;
    for (const uint16_t sequence : {uint16_t(65'534), uint16_t(1)}) {
        world.change([&] { world.incoming.push_back(report_of(sequence, 0)); });
        REQUIRE(next_result(*device, state) == ReadResult::fresh);
    }
    CHECK(state.sequence == 65'537);
}

TEST_CASE("a malformed report is told of and leaves the state alone")
{
    World world;
    const auto device = make_link(world, reference(), true);
    DeviceState state;
    world.change([&] { world.incoming.push_back(report_of(3, 5000)); });
    REQUIRE(next_result(*device, state) == ReadResult::fresh);
    for (const Bytes& bad : {Bytes{1, 2, 3}, Bytes(64, 0x01), Bytes(33, 0x09), Bytes(100, 0x01)}) {
        world.change([&] { world.incoming.push_back(bad); });
        CHECK(next_result(*device, state) == ReadResult::malformed);
        CHECK(state.sequence == 3);
        CHECK(state.position_m.x == doctest::Approx(0.005));
    }
    CHECK(device->read(state) == ReadResult::stale);
}

TEST_CASE("write returns while the device blocks, and the newest force is what goes out next")
{
    World world;
    world.writes_block = true;
    const auto device = make_link(world, reference(), true);
    CHECK(device->caps().outputs_force);
    for (uint32_t i = 1; i <= 1000; ++i) CHECK(device->write({i * 1e-3, 0.0, 0.0}, i));
    CHECK(world.all_written().empty());  // all 1000 returned although none could be written
    world.change([&] { world.writes_block = false; });
    CHECK(comes_true([&] {
        const std::vector<Bytes> written = world.all_written();
        return !written.empty() && force_x_mn(written.back()) == 1000;
    }));
    const std::vector<Bytes> written = world.all_written();
    CHECK(written.size() <= 2);  // at most the one in progress and the newest
    CHECK(is_enabled(written.back()));
    CHECK(written.back()[2] == 20);
}

TEST_CASE("the last report switches the force off")
{
    World world;
    {
        const auto device = make_link(world, reference(), true);
        device->write({1.0, 0.0, 0.0}, 1);
        CHECK(comes_true([&] { return !world.all_written().empty(); }));
    }
    const Bytes last = world.all_written().back();
    CHECK_FALSE(is_enabled(last));
    CHECK(force_x_mn(last) == 0);
}

TEST_CASE("force is refused unless it is allowed and the profile is verified; an unverified layout gets no bytes")
{
    for (const bool is_verified : {true, false}) {
        World world;
        HidProfile profile = reference();
        profile.verified = is_verified;
        {
            const auto device = make_link(world, profile, !is_verified);
            CHECK_FALSE(device->caps().outputs_force);
            for (uint32_t i = 0; i < 20; ++i) {
                device->write({1.0, 0.0, 0.0}, i);
                std::this_thread::sleep_for(milliseconds(1));
            }
        }
        const std::vector<Bytes> written = world.all_written();
        CHECK(written.empty() == !is_verified);
        for (const Bytes& report : written) {
            CHECK_FALSE(is_enabled(report));
            CHECK(force_x_mn(report) == 0);
        }
    }
}

TEST_CASE("an unplugged device is lost, and is there again after it was plugged in")
{
    World world;
    const auto device = make_link(world, reference(), true);
    DeviceState state;
    for (int round = 0; round < 3; ++round) {
        // A report not fetched before the loss is not fresh afterwards.
        world.change([&] { world.incoming.push_back(report_of(1000, 1)); });
        std::this_thread::sleep_for(milliseconds(5));
        world.change([&] { world.is_plugged = false; });
        CHECK(comes_true([&] { return device->read(state) == ReadResult::lost; }));
        CHECK_FALSE(device->write({0.0, 0.0, 0.0}, 1));
        std::this_thread::sleep_for(milliseconds(20));
        CHECK(device->read(state) == ReadResult::lost);

        const SteadyClock::time_point start = SteadyClock::now();
        world.change([&] {
            world.is_plugged = true;
            world.incoming = {report_of(uint16_t(round + 1), 77)};
        });
        state = {};
        CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh; }));
        CHECK(state.sequence == uint32_t(round + 1));
        CHECK(device->write({0.0, 0.0, 0.0}, 2));
        MESSAGE("reconnected after ", std::chrono::duration<double, std::milli>(SteadyClock::now() - start).count(),
                " ms");
    }
    CHECK(world.opened == 4);
}

TEST_CASE("a device that is gone while a write blocks is neither waited for nor read")
{
    World world;
    const auto device = make_link(world, reference(), true);
    DeviceState state;
    world.change([&] { world.writes_block = true; });
    device->write({1.0, 0.0, 0.0}, 1);
    std::this_thread::sleep_for(milliseconds(5));
    world.change([&] { world.is_plugged = false; });
    CHECK(comes_true([&] { return device->read(state) == ReadResult::lost; }));
    world.change([&] { world.writes_block = false; });
    world.change([&] {
        world.is_plugged = true;
        world.incoming = {report_of(1, 0)};
    });
    CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh; }));
}

TEST_CASE("the device's own limits are asked for when it is opened")
{
    World world;
    world.feature = {3, 0xd0, 0x07, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const auto device = make_link(world, reference(), true);
    CHECK(device->caps().peak_force_n == doctest::Approx(2.0));
}

TEST_CASE("another device that is plugged in is asked for its own limits before it is read")
{
    World world;
    world.feature = {3, 0xd0, 0x07, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    const auto device = make_link(world, reference(), true);
    CHECK(device->caps().peak_force_n == doctest::Approx(2.0));
    DeviceState state;
    world.change([&] { world.is_plugged = false; });
    CHECK(comes_true([&] { return device->read(state) == ReadResult::lost; }));
    CHECK(device->trouble() == std::string("the device was unplugged"));
    world.change([&] {
        world.feature[1] = 0xe8;
        world.feature[2] = 0x03;
        world.is_plugged = true;
        world.incoming = {report_of(1, 0)};
    });
    CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh; }));
    CHECK(device->caps().peak_force_n == doctest::Approx(1.0));
    CHECK(device->caps().outputs_force);
    CHECK(device->trouble() == std::string());
}

TEST_CASE("a device that states speeds moves as long as it says so, within its box, and rests in silence")
{
    World world;
    const HidProfile profile = load_hid_profile("assets/devices/spacemouse.json");
    static std::atomic<uint64_t> now_ns{0};
    now_ns = 1'000'000'000;
    const auto device = make_hid_link(profile, std::make_unique<FakePort>(world), [] { return nullptr; },
                                      {.now_ns = [] { return now_ns.load(); }});
    CHECK(device->caps().rate_control);
    CHECK_FALSE(device->caps().outputs_force);
    DeviceState state;
    const auto tick = [&] {
        now_ns += 1'000'000;
        CHECK(device->read(state) == ReadResult::fresh);  // silence is rest, not absence
    };
    for (int i = 0; i < 100; ++i) tick();
    CHECK(state.position_m == glm::dvec3(0.0));
    CHECK(state.sequence == 100);
    CHECK(state.time_ns == now_ns);

    const auto send = [&](const Bytes& report) {
        world.change([&] { world.incoming.push_back(report); });
        CHECK(comes_true([&] {  // without time, no motion
            device->read(state);
            const std::lock_guard lock(world.mutex);
            return world.incoming.empty();
        }));
    };
    const Bytes right{1, 0x5e, 0x01, 0, 0, 0, 0};
    send(right);
    CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh && state.rate.x == doctest::Approx(1.0); }));
    const double start = state.position_m.x;
    for (int i = 0; i < 100; ++i) tick();
    CHECK(state.position_m.x - start == doctest::Approx(0.1 * profile.rate->speed));
    send({3, 1, 0});  // a button leaves the motion as it is
    CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh && state.buttons == 1; }));
    CHECK(state.rate.x == doctest::Approx(1.0));
    // Time runs faster here than the reader, which tells the newest of what it finds: each report has to be felt before
    // time goes on.
    const Bytes nearly_right{1, 0x5d, 0x01, 0, 0, 0, 0};
    for (int i = 0; i < 10'000; ++i) {
        if (i % 100 == 0) {
            const bool is_full = i % 200 == 0;
            send(is_full ? right : nearly_right);
            CHECK(comes_true(
                [&] { return device->read(state) == ReadResult::fresh && (state.rate.x > 0.999) == is_full; }));
        }
        tick();
    }
    CHECK(state.position_m.x == profile.limits.usable_upper_m.x);

    // Without another word it rests after 200 ms.
    send({1, 0xa2, 0xfe, 0, 0, 0, 0});
    CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh && state.rate.x < -0.9; }));
    for (int i = 0; i < 199; ++i) tick();
    const double last = state.position_m.x;
    CHECK(last < profile.limits.usable_upper_m.x);
    for (int i = 0; i < 300; ++i) tick();
    CHECK(state.position_m.x == doctest::Approx(last).epsilon(0.01));
    CHECK(state.rate == glm::dvec3(0.0));

    // A force draws it along, as it does the mouse: F / 75 N/m.
    const glm::dvec3 place = state.position_m;
    for (int i = 0; i < 200; ++i) {
        CHECK(device->write({0.0, 0.3, 0.0}, 1));
        tick();
    }
    CHECK(state.position_m.y - place.y == doctest::Approx(0.004));
    CHECK(world.all_written().empty());
}

TEST_CASE("a device that states speeds turns about its axes")
{
    World world;
    const HidProfile profile = load_hid_profile("assets/devices/spacemouse.json");
    static std::atomic<uint64_t> now_ns{0};
    now_ns = 1'000'000'000;
    const auto device = make_hid_link(profile, std::make_unique<FakePort>(world), [] { return nullptr; },
                                      {.now_ns = [] { return now_ns.load(); }});
    DeviceState state;
    device->read(state);
    world.change([&] { world.incoming.push_back({2, 0x5e, 0x01, 0, 0, 0, 0}); });
    CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh && state.turn_rate.x > 0.99; }));
    for (int i = 0; i < 100; ++i) {
        now_ns += 1'000'000;
        device->read(state);
    }
    CHECK(glm::angle(state.rotation) == doctest::Approx(0.1 * profile.rate->turn_speed));
    CHECK(glm::axis(state.rotation).x == doctest::Approx(1.0));
    CHECK(glm::dot(state.rotation, state.rotation) == doctest::Approx(1.0));
}

TEST_CASE("reports of several kinds make one state, and there is none before the first place")
{
    World world;
    HidProfile profile = reference();
    HidReport buttons;
    buttons.id = 9;
    buttons.length = 1;
    buttons.fields = {{.quantity = HidQuantity::buttons, .bit = 0, .bits = 8}};
    std::erase_if(profile.inputs[0].fields, [](const HidField& f) { return f.quantity == HidQuantity::buttons; });
    profile.inputs.push_back(buttons);
    profile.ignored_ids = {7};
    const auto device = make_link(world, profile, true);
    DeviceState state;
    world.change([&] { world.incoming = {Bytes{9, 1}, Bytes{7, 1, 2}}; });
    std::this_thread::sleep_for(milliseconds(30));
    CHECK(device->read(state) == ReadResult::stale);  // neither a place nor a fault
    world.change([&] { world.incoming = {report_of(3, 5000)}; });
    REQUIRE(next_result(*device, state) == ReadResult::fresh);
    CHECK(state.buttons == 1);
    CHECK(state.position_m.x == doctest::Approx(0.005));
    world.change([&] { world.incoming = {Bytes{9, 2}}; });
    REQUIRE(next_result(*device, state) == ReadResult::fresh);
    CHECK(state.buttons == 2);
    CHECK(state.position_m.x == doctest::Approx(0.005));
}

TEST_CASE("a servo runs on a device whose writes take a millisecond, and stops with its force off")
{
    World world;
    world.write_time = milliseconds(1);
    std::atomic<bool> is_sending{true};
    std::thread sender([&] {
        for (uint16_t i = 1; is_sending; ++i) {
            world.change([&] { world.incoming.push_back(report_of(i, 0)); });
            std::this_thread::sleep_for(milliseconds(1));
        }
    });
    {
        Servo servo(make_link(world, reference(), true), real_pacing(), {.rate_hz = 1000, .realtime = false});
        const auto state_is = [&](const auto& claim) {
            return comes_true([&] { return servo.state().take() && claim(servo.state().value()); });
        };
        CHECK(state_is([](const ServoState& s) { return s.device.sequence > 50 && s.step.flags == 0; }));
        CHECK(servo.state().value().caps.outputs_force);
        world.change([&] { world.is_plugged = false; });
        CHECK(state_is([](const ServoState& s) { return s.step.flags == FORCE_NO_DEVICE; }));
        world.change([&] { world.is_plugged = true; });
        CHECK(state_is([](const ServoState& s) { return s.step.flags == 0; }));
    }
    is_sending = false;
    sender.join();
    const std::vector<Bytes> written = world.all_written();
    REQUIRE(written.size() > 10);
    CHECK_FALSE(is_enabled(written.back()));
}

TEST_CASE("where no profile matches a device there is none, and that is no error")
{
    HidProfile nobodys = reference();
    nobodys.matches = {{.vendor = 0xfffe, .product = 0xfffd}};
    CHECK(open_hid_device({}, true) == nullptr);
    CHECK(open_hid_device({nobodys}, true) == nullptr);
    for (const HidListing& device : list_hid_devices(std::vector{nobodys})) CHECK(device.profile.empty());
}
