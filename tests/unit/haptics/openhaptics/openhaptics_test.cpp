#include "haptics/openhaptics/openhaptics_device.h"

#include <dlfcn.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "haptics/servo.h"
#include "tests/stubs/hd_stub.h"

using namespace shvr;
using std::chrono::milliseconds;

namespace {

using Clock = std::chrono::steady_clock;

/// Path of a stub library, in stubs/ of the test program's folder.
std::string library(const std::string& name)
{
    return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "stubs" / name).string();
}

/// The stub as new.
HdStub& stub()
{
    static void* const loaded = ::dlopen(library("libhd_stub.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    REQUIRE(loaded);
    HdStub& stub = *reinterpret_cast<HdStubControl>(::dlsym(loaded, "stub_control"))();
    stub.is_there = true;
    stub.init_error = stub.next_error = 0;
    stub.calibration = stub.calibration_after_update = 0x5000;
    stub.temperature = 0.1;
    stub.buttons = 0;
    stub.repeats_error = false;
    for (int i = 0; i < 3; ++i) stub.position_mm[i] = stub.force_n[i] = 0.0;
    stub.inits = stub.disables = stub.updates = stub.ticks = stub.unframed = 0;
    return stub;
}

OpenHapticsOptions options(bool allow_force = true)
{
    return {.library = library("libhd_stub.so"), .allow_force = allow_force};
}

std::string error_of(const OpenHapticsOptions& wanted)
{
    try {
        open_openhaptics(wanted);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

template <class Claim>
bool comes_true(const Claim& claim)
{
    const Clock::time_point end = Clock::now() + std::chrono::seconds(20);
    while (Clock::now() < end) {
        if (claim()) return true;
        std::this_thread::sleep_for(milliseconds(1));
    }
    return false;
}

/// Writes a force along x like a servo until the claim holds.
template <class Claim>
bool pulls_until(HapticDevice& device, const Claim& claim)
{
    uint32_t sequence = 0;
    return comes_true([&] {
        device.write({1.0, 0.0, 0.0}, ++sequence);
        return claim();
    });
}

}  // namespace

TEST_CASE("states and limits of the driver arrive in SI units")
{
    HdStub& arm = stub();
    arm.position_mm[0] = 12.0;
    arm.position_mm[2] = -30.0;
    arm.buttons = 1 | 4;
    {
        const auto device = open_openhaptics(options());
        REQUIRE(device);
        CHECK(device->model() == "Stub Touch");
        CHECK(device->serial() == "S-0001");
        const DeviceCaps caps = device->caps();
        CHECK(caps.peak_force_n == 3.0);
        CHECK(caps.continuous_force_n == 0.5);
        CHECK(caps.usable_upper_m == glm::dvec3(0.08, 0.06, 0.035));
        CHECK(caps.outputs_force);
        DeviceState state;
        CHECK(comes_true([&] { return device->read(state) == ReadResult::fresh; }));
        CHECK(state.position_m == glm::dvec3(0.012, 0.0, -0.030));
        CHECK(state.buttons == PAINT_BUTTON);
        CHECK(glm::length(state.rotation * glm::dvec3(1, 0, 0) - glm::dvec3(0, 1, 0)) < 1e-12);
        CHECK(comes_true([&] { return device->motor_temperature() == 0.1; }));
        CHECK_THROWS_AS(open_openhaptics(options()), Error);  // one at a time
    }
    CHECK(arm.unframed == 0);
    CHECK(arm.inits == 1);
    CHECK(arm.disables == 1);
}

TEST_CASE("a force arrives within its limits, and ends with the device, a silent servo, or warm motors")
{
    HdStub& arm = stub();
    {
        const auto device = open_openhaptics(options());
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 1.0; }));
        CHECK(arm.is_force_on);
        CHECK(comes_true([&] {
            device->write({0.0, 9.0, 0.0}, 1);
            return arm.force_n[1] == 3.0;
        }));
        CHECK(comes_true([&] { return arm.force_n[1] == 0.0; }));  // without writes
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 1.0; }));
        arm.temperature = 0.96;
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 0.0; }));
        CHECK(std::string(device->trouble()).find("too warm") != std::string::npos);
        DeviceState state;
        CHECK(pulls_until(*device, [&] { return device->read(state) == ReadResult::fresh && !state.calibrated; }));
        arm.temperature = 0.9;
        const int ticks = arm.ticks;
        CHECK(pulls_until(*device, [&] { return arm.ticks > ticks + 20; }));
        CHECK(arm.force_n[0] == 0.0);  // not yet cool
        arm.temperature = 0.7;
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 1.0; }));
        CHECK(comes_true([&] { return device->trouble() == std::string(); }));
        device->write({1.0 / 0.0, 0.0, 0.0}, 1);
        CHECK(comes_true([&] { return arm.force_n[0] == 0.0; }));
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 1.0; }));
    }
    CHECK(arm.force_n[0] == 0.0);
    CHECK_FALSE(arm.is_force_on);
}

TEST_CASE("without permission the driver is never asked for a force")
{
    HdStub& arm = stub();
    const auto device = open_openhaptics(options(false));
    CHECK_FALSE(device->caps().outputs_force);
    CHECK(pulls_until(*device, [&] { return arm.ticks > 20; }));
    CHECK_FALSE(arm.is_force_on);
    CHECK(arm.force_n[0] == 0.0);
}

TEST_CASE("errors take the force back; a fault or a lost connection ends the device")
{
    HdStub& arm = stub();
    SUBCASE("moved too fast")
    {
        const auto device = open_openhaptics(options());
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 1.0; }));
        arm.next_error = 0x0203;
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 0.0; }));
        CHECK(std::string(device->trouble()).find("beyond its limits") != std::string::npos);
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 1.0; }));
        DeviceState state;
        CHECK(device->read(state) != ReadResult::lost);
    }
    SUBCASE("connection")
    {
        const auto device = open_openhaptics(options());
        CHECK(pulls_until(*device, [&] { return arm.force_n[0] == 1.0; }));
        arm.next_error = 0x0302;
        DeviceState state;
        CHECK(pulls_until(*device, [&] { return device->read(state) == ReadResult::lost; }));
        CHECK_FALSE(device->write({}, 1));
        CHECK(std::string(device->trouble()).find("does not answer") != std::string::npos);
    }
    SUBCASE("an error without end")
    {
        const auto device = open_openhaptics(options());
        arm.next_error = 0x0201;
        arm.repeats_error = true;
        DeviceState state;
        CHECK(pulls_until(*device, [&] { return device->read(state) == ReadResult::lost; }));
    }
}

TEST_CASE("what keeps the device from being used is said in words")
{
    CHECK(open_openhaptics({.library = "libthere_is_none.so"}) == nullptr);
    CHECK(error_of({.library = library("libhd_partial.so")})
              .find("lacks the function hdDisableDevice; expected OpenHaptics 3.4") != std::string::npos);
    HdStub& arm = stub();
    arm.is_there = false;
    CHECK(error_of(options()).find("no device: none was found; expected one that is set up") != std::string::npos);
    arm.init_error = 0x0302;
    CHECK(error_of(options()).find("communication error, internal -28); expected its cable and power") !=
          std::string::npos);
    arm.init_error = 0x0300;
    CHECK(error_of(options()).find("it reports a fault") != std::string::npos);
    arm.init_error = 0x0200;
    CHECK(error_of(options()).find("motors are too warm; expected a rest") != std::string::npos);
    arm.init_error = 0x0105;
    CHECK(error_of(options()).find("its driver says \"a text of the driver\" (261)") != std::string::npos);
    arm.init_error = 0;
    arm.is_there = true;
    arm.calibration = 0x5002;
    CHECK(error_of(options()).find("Stub Touch: is not calibrated; expected the stylus in its inkwell") !=
          std::string::npos);
    arm.calibration = arm.calibration_after_update = 0x5001;
    CHECK(error_of(options()).find("is not calibrated") != std::string::npos);
    CHECK(arm.updates == 1);
    arm.calibration = 0x5001;
    arm.calibration_after_update = 0x5000;
    CHECK(open_openhaptics(options()) != nullptr);
    CHECK(arm.updates == 2);
}

TEST_CASE("a servo runs on the driver's clock")
{
    HdStub& arm = stub();
    Servo servo(open_openhaptics(options()), real_pacing(), {.rate_hz = 1000, .realtime = false});
    CHECK(comes_true([&] {
        return servo.state().take() && servo.state().value().device.sequence > 50 &&
               servo.state().value().step.flags == 0;
    }));
    arm.next_error = 0x0300;
    CHECK(comes_true([&] { return servo.state().take() && servo.state().value().step.flags == FORCE_NO_DEVICE; }));
}
