// Device and host in one: a HID device of the kernel's uhid, in the reference layout, and SHVR's link through hidapi
// and hidraw. Runs as root in the virtual machine of tools/test_in_vm; `hid_kernel PROFILE TICKS`. Prints figures, a
// hash of all that was exchanged, and "N passed, N failed" at the end.

#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
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

int32_t place_um(uint32_t tick, uint32_t axis)
{
    return int32_t((tick * (7 + 4 * axis) + 13 * axis) % 40'001) - 20'000;
}

/// The arm: its thread answers the kernel.
class Arm {
public:
    explicit Arm(uint16_t peak_mn) : peak_mn_(peak_mn), descriptor_(::open("/dev/uhid", O_RDWR | O_CLOEXEC))
    {
        uhid_event event{};
        event.type = UHID_CREATE2;
        uhid_create2_req& create = event.u.create2;
        std::snprintf(reinterpret_cast<char*>(create.name), sizeof create.name, "SHVR virtual arm");
        std::snprintf(reinterpret_cast<char*>(create.uniq), sizeof create.uniq, "VM-0001");
        create.rd_size = sizeof DESCRIPTOR;
        create.bus = 3;
        create.vendor = 0x1209;
        create.product = 0x0001;
        std::memcpy(create.rd_data, DESCRIPTOR, sizeof DESCRIPTOR);
        tell(event);
        thread_ = std::thread(&Arm::run, this);
    }
    ~Arm()
    {
        is_running_ = false;
        thread_.join();
        uhid_event event{};
        event.type = UHID_DESTROY;
        tell(event);
        ::close(descriptor_);
    }
    bool is_there() const { return descriptor_ >= 0; }

    void send(uint32_t tick)
    {
        uhid_event event{};
        event.type = UHID_INPUT2;
        uint8_t* const bytes = event.u.input2.data;
        event.u.input2.size = 33;
        bytes[0] = 1;
        bytes[1] = uint8_t(tick >> 8 & 1);
        bytes[2] = 1;
        const auto put = [&](size_t at, uint32_t value, size_t count) {
            for (size_t i = 0; i < count; ++i) bytes[at + i] = uint8_t(value >> (8 * i));
        };
        put(3, tick, 2);
        put(5, tick * 1000, 4);
        for (uint32_t axis = 0; axis < 3; ++axis) put(9 + 4 * axis, uint32_t(place_um(tick, axis)), 4);
        put(21, 0x7fff, 2);
        tell(event);
    }
    uint32_t outputs() const { return outputs_; }
    /// The last output report.
    std::array<uint8_t, 17> last() const
    {
        std::array<uint8_t, 17> bytes;
        for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = last_[i];
        return bytes;
    }

private:
    void tell(const uhid_event& event)
    {
        if (::write(descriptor_, &event, sizeof event) != ssize_t(sizeof event)) std::printf("uhid refuses an event\n");
    }
    void run()
    {
        while (is_running_) {
            pollfd each{descriptor_, POLLIN, 0};
            if (::poll(&each, 1, 2) <= 0) continue;
            uhid_event event{};
            if (::read(descriptor_, &event, sizeof event) <= 0) continue;
            if (event.type == UHID_OUTPUT) {
                for (size_t i = 0; i < last_.size(); ++i) last_[i] = event.u.output.data[i];
                ++outputs_;
            }
            if (event.type == UHID_GET_REPORT) {
                uhid_event answer{};
                answer.type = UHID_GET_REPORT_REPLY;
                answer.u.get_report_reply.id = event.u.get_report.id;
                answer.u.get_report_reply.size = 17;
                answer.u.get_report_reply.data[0] = 3;
                answer.u.get_report_reply.data[1] = uint8_t(peak_mn_);
                answer.u.get_report_reply.data[2] = uint8_t(peak_mn_ >> 8);
                tell(answer);
            }
        }
    }

    uint16_t peak_mn_;
    int descriptor_;
    std::atomic<bool> is_running_{true};
    std::atomic<uint32_t> outputs_{0};
    std::array<std::atomic<uint8_t>, 17> last_{};
    std::thread thread_;
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

}  // namespace

int main(int count, char** arguments)
{
    if (count != 3) return 2;
    const std::vector<HidProfile> profiles{load_hid_profile(arguments[1])};
    const uint32_t ticks = uint32_t(std::atoi(arguments[2]));
    auto arm = std::make_unique<Arm>(uint16_t(2000));
    check(arm->is_there(), "uhid opens");
    check(comes_true([&] { return !list_hid_devices(profiles).empty(); }), "the device is listed");
    const std::vector<HidListing> listed = list_hid_devices(profiles);
    check(listed.size() == 1 && listed[0].serial == "VM-0001" && listed[0].usage_page == 0xff00 &&
              listed[0].profile == "SHVR reference layout",
          "its serial, usage page and profile");

    auto device = open_hid_device(profiles, true);
    check(device != nullptr, "it opens");
    if (!device) return 1;
    check(device->caps().peak_force_n == 2.0 && device->caps().outputs_force, "its limits are asked for");

    Figures figures = run(*arm, *device, ticks);
    std::printf("ticks %u, lost inputs %u, lost outputs %u, late %u\n", ticks, figures.lost_inputs,
                figures.lost_outputs, figures.late);
    print("report to servo", figures.input_us);
    print("report to force", figures.round_us);
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
    std::printf("%d passed, %d failed\n", passed, failed);
    return failed == 0 ? 0 : 1;
}
