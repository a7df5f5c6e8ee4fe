// Device and host in one: HID devices of the kernel's uhid, an arm in the reference layout and a SpaceMouse, and SHVR's
// link through hidapi and hidraw. Runs as root in the virtual machine of tools/test_in_vm; `hid_kernel PROFILE
// MOUSE_PROFILE TICKS`. Prints figures, a hash of all that was exchanged, and "N passed, N failed" at the end.

#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "haptics/hid/hid_device.h"
#include "haptics/hid/hid_profile.h"
#include "tests/vm/uhid_device.h"

namespace {

using namespace shvr;
using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;
using std::chrono::milliseconds;

int passed = 0, failed = 0;
void check(bool claim, const char* what)
{
    ++(claim ? passed : failed);
    if (!claim) std::printf("FAILED: %s\n", what);
}

// Vendor page 0xff00; reports 1 in (32 bytes), 2 out (16), 3 feature (16).
constexpr uint8_t DESCRIPTOR[]{0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75,
                               0x08, 0x85, 0x01, 0x95, 0x20, 0x09, 0x01, 0x81, 0x02, 0x85, 0x02, 0x95, 0x10,
                               0x09, 0x02, 0x91, 0x02, 0x85, 0x03, 0x95, 0x10, 0x09, 0x03, 0xb1, 0x02, 0xc0};

// Generic desktop, multi-axis controller: report 1, three places of 16 bits; 2, three turns; 3, two buttons.
constexpr uint8_t MOUSE_DESCRIPTOR[]{
    0x05, 0x01, 0x09, 0x08, 0xa1, 0x01, 0xa1, 0x00, 0x85, 0x01, 0x16, 0xa2, 0xfe, 0x26, 0x5e, 0x01,  //
    0x09, 0x30, 0x09, 0x31, 0x09, 0x32, 0x75, 0x10, 0x95, 0x03, 0x81, 0x06, 0xc0,                    //
    0xa1, 0x00, 0x85, 0x02, 0x16, 0xa2, 0xfe, 0x26, 0x5e, 0x01, 0x09, 0x33, 0x09, 0x34, 0x09, 0x35,  //
    0x75, 0x10, 0x95, 0x03, 0x81, 0x06, 0xc0,                                                        //
    0xa1, 0x02, 0x85, 0x03, 0x05, 0x09, 0x19, 0x01, 0x29, 0x02, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01,  //
    0x95, 0x02, 0x81, 0x02, 0x95, 0x0e, 0x81, 0x01, 0xc0, 0xc0};

int32_t place_um(uint32_t tick, uint32_t axis)
{
    return int32_t((tick * (7 + 4 * axis) + 13 * axis) % 40'001) - 20'000;
}

/// The arm: a device of the reference layout.
class Arm {
public:
    explicit Arm(uint16_t peak_mn)
        : device_({"SHVR virtual arm", "VM-0001", 0x1209, 0x0001, DESCRIPTOR}, feature_report(peak_mn))
    {}
    bool is_there() const { return device_.is_there(); }
    void send(uint32_t tick)
    {
        std::array<uint8_t, 33> bytes{1, uint8_t(tick >> 8 & 1), 1};
        const auto put = [&](size_t at, uint32_t value, size_t count) {
            for (size_t i = 0; i < count; ++i) bytes[at + i] = uint8_t(value >> (8 * i));
        };
        put(3, tick, 2);
        put(5, tick * 1000, 4);
        for (uint32_t axis = 0; axis < 3; ++axis) put(9 + 4 * axis, uint32_t(place_um(tick, axis)), 4);
        put(21, 0x7fff, 2);
        device_.send(bytes);
    }
    uint32_t outputs() const { return device_.outputs(); }
    std::array<uint8_t, 17> last() const { return device_.last(); }

private:
    static std::vector<uint8_t> feature_report(uint16_t peak_mn)
    {
        std::vector<uint8_t> bytes(17);
        bytes[0] = 3;
        bytes[1] = uint8_t(peak_mn);
        bytes[2] = uint8_t(peak_mn >> 8);
        return bytes;
    }

    UhidDevice device_;
};

template <class Claim>
bool comes_true(const Claim& claim, milliseconds most = milliseconds(2000))
{
    const Clock::time_point end = Clock::now() + most;
    while (Clock::now() < end) {
        if (claim()) return true;
        std::this_thread::sleep_for(microseconds(50));
    }
    return false;
}

double us_since(Clock::time_point start)
{
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

struct Figures {
    uint32_t lost_inputs = 0, lost_outputs = 0, late = 0;
    uint64_t hash = 14695981039346656037u;
    std::vector<double> input_us, round_us;
    void note(const void* bytes, size_t size)
    {
        for (size_t i = 0; i < size; ++i) hash = (hash ^ static_cast<const uint8_t*>(bytes)[i]) * 1099511628211u;
    }
};

/// A report each millisecond; the servo's side answers each with a force of its own.
Figures run(Arm& arm, HapticDevice& device, uint32_t ticks)
{
    Figures figures;
    for (std::vector<double>* times : {&figures.input_us, &figures.round_us}) {
        times->resize(ticks);  // pages that are touched for the first time would make ticks late
        times->clear();
    }
    DeviceState state;
    Clock::time_point due = Clock::now();
    for (uint32_t tick = 1; tick <= ticks; ++tick) {
        due += milliseconds(1);
        if (Clock::now() > due) {
            ++figures.late;
            due = Clock::now();
        }
        std::this_thread::sleep_until(due);
        const Clock::time_point start = Clock::now();
        arm.send(tick);
        const bool is_read = comes_true(
            [&] { return device.read(state) == ReadResult::fresh && (state.sequence & 0xffff) == (tick & 0xffff); },
            milliseconds(100));
        figures.lost_inputs += is_read ? 0 : 1;
        figures.input_us.push_back(us_since(start));
        figures.note(&state.position_m, sizeof state.position_m);
        const uint32_t before = arm.outputs();
        device.write(state.position_m * 50.0, tick);
        const bool is_written = comes_true([&] { return arm.outputs() == before + 1; }, milliseconds(100));
        const std::array<uint8_t, 17> output = arm.last();
        const bool is_ours = output[3] == uint8_t(tick) && output[4] == uint8_t(tick >> 8) && (output[1] & 1);
        figures.lost_outputs += is_written && is_ours ? 0 : 1;
        figures.round_us.push_back(us_since(start));
        figures.note(output.data(), output.size());
    }
    return figures;
}

void print(const char* what, std::vector<double>& us)
{
    std::ranges::sort(us);
    const auto at = [&](double share) { return us[size_t(share * double(us.size() - 1))]; };
    std::printf("%s: p50 %.0f us, p99 %.0f us, p99.9 %.0f us, max %.0f us\n", what, at(0.5), at(0.99), at(0.999),
                us.back());
}

void check_arm(const HidProfile& profile, uint32_t ticks)
{
    const std::vector<HidProfile> profiles{profile};
    auto arm = std::make_unique<Arm>(uint16_t(2000));
    check(arm->is_there(), "uhid opens");
    check(comes_true([&] { return !list_hid_devices(profiles).empty(); }), "the device is listed");
    const std::vector<HidListing> listed = list_hid_devices(profiles);
    check(listed.size() == 1 && listed[0].serial == "VM-0001" && listed[0].usage_page == 0xff00 &&
              listed[0].profile == "SHVR reference layout",
          "its serial, usage page and profile");

    auto device = open_hid_device(profiles, true);
    check(device != nullptr, "it opens");
    if (!device) return;
    check(device->caps().peak_force_n == 2.0 && device->caps().outputs_force, "its limits are asked for");

    Figures figures = run(*arm, *device, ticks);
    std::printf("ticks %u, lost inputs %u, lost outputs %u, late %u\n", ticks, figures.lost_inputs,
                figures.lost_outputs, figures.late);
    print("report to servo", figures.input_us);
    print("report to force", figures.round_us);
    check(figures.late == 0, "no tick is late");
    check(figures.lost_inputs == 0, "no report is lost");
    check(figures.lost_outputs == 0, "no force is lost");

    DeviceState state;
    Clock::time_point start = Clock::now();
    arm.reset();
    check(comes_true([&] { return device->read(state) == ReadResult::lost; }), "unplugging is noticed");
    std::printf("unplugged: lost after %.2f ms\n", us_since(start) * 1e-3);
    check(!device->write({}, 1), "writing after it says so");
    arm = std::make_unique<Arm>(uint16_t(1000));
    start = Clock::now();
    check(comes_true([&] {
              arm->send(7);
              return device->read(state) == ReadResult::fresh;
          }),
          "plugged in again, it is read");
    std::printf("plugged in: read after %.2f ms\n", us_since(start) * 1e-3);
    check(device->caps().peak_force_n == 1.0, "its new limits are asked for");
    check(comes_true([&] {
              device->write({0.5, 0.0, 0.0}, 9);
              return arm->last()[5] == 0xf4 && arm->last()[6] == 0x01;
          }),
          "a force reaches it");
    device.reset();
    check(comes_true([&] { return (arm->last()[1] & 1) == 0 && arm->last()[5] == 0; }),
          "closing switches the force off");
    std::printf("hash %016llx\n", static_cast<unsigned long long>(figures.hash));
}

/// Six axes of speed without motors, as by its profile: 60 mm/s at full deflection.
void check_space_mouse(const HidProfile& profile)
{
    const std::vector<HidProfile> profiles{profile};
    const UhidDevice::Identity identity{"SHVR virtual mouse", "VM-0002", 0x256f, 0xc635, MOUSE_DESCRIPTOR};
    auto mouse = std::make_unique<UhidDevice>(identity, std::vector<uint8_t>{});
    const auto is_listed = [&] {
        return std::ranges::any_of(list_hid_devices(profiles), [&](const HidListing& found) {
            return found.profile == profile.name && found.serial == "VM-0002" && found.usage_page == 1 &&
                   found.usage == 8;
        });
    };
    check(comes_true(is_listed), "the mouse is listed with its usage");
    const auto device = open_hid_device(profiles, true);
    check(device != nullptr, "the mouse opens");
    if (!device) return;
    check(device->caps().rate_control && !device->caps().outputs_force, "it states speeds and has no motors");

    constexpr std::array<uint8_t, 7> RIGHT{1, 0x5e, 0x01}, TURNED{2, 0, 0, 0, 0, 0xa2, 0xfe}, STILL{1};
    constexpr std::array<uint8_t, 3> PRESSED{3, 1, 0};
    DeviceState state;
    const auto reads = [&](const auto& report, const auto& claim) {
        return comes_true([&] {
            mouse->send(report);
            return device->read(state) == ReadResult::fresh && claim();
        });
    };
    check(reads(RIGHT, [&] { return state.rate == glm::dvec3(1.0, 0.0, 0.0); }), "it is pushed to the right");
    const DeviceState before = state;
    check(reads(RIGHT, [&] { return state.time_ns > before.time_ns + 100'000'000; }), "it goes on for 0.1 s");
    const double passed_s = double(state.time_ns - before.time_ns) * 1e-9;
    const glm::dvec3 way_m = state.position_m - before.position_m;
    check(std::abs(way_m.x - 0.06 * passed_s) < 1e-4 * passed_s && way_m.y == 0.0 && way_m.z == 0.0,
          "it moves at 60 mm/s");
    check(reads(TURNED, [&] { return state.turn_rate == glm::dvec3(0.0, 1.0, 0.0); }), "it is turned about its z axis");
    check(reads(PRESSED, [&] { return state.buttons == PAINT_BUTTON; }), "its first button paints");
    check(reads(STILL, [&] { return state.rate == glm::dvec3(0.0); }), "it is let go");
    check(reads(RIGHT, [&] { return state.rate.x == 1.0; }), "it is pushed again");
    check(comes_true([&] { return device->read(state) == ReadResult::fresh && state.rate.x == 0.0; }),
          "it rests where nothing is heard of it");

    mouse.reset();
    check(comes_true([&] { return device->read(state) == ReadResult::lost; }), "its unplugging is noticed");
    mouse = std::make_unique<UhidDevice>(identity, std::vector<uint8_t>{});
    check(comes_true([&] { return device->read(state) == ReadResult::fresh; }), "it is found again");
    check(state.rate == glm::dvec3(0.0) && state.turn_rate == glm::dvec3(0.0), "and does not move on by itself");
    check(reads(RIGHT, [&] { return state.rate.x == 1.0; }), "it is read again");
}

}  // namespace

int main(int count, char** arguments)
{
    if (count != 4) return 2;
    // Same scheduling as the servo.
    const sched_param priority{.sched_priority = 40};
    check(sched_setscheduler(0, SCHED_FIFO, &priority) == 0, "the host's thread is a real-time one");
    check_arm(load_hid_profile(arguments[1]), uint32_t(std::atoi(arguments[3])));
    check_space_mouse(load_hid_profile(arguments[2]));
    std::printf("%d passed, %d failed\n", passed, failed);
    return failed == 0 ? 0 : 1;
}
