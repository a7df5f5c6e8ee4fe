// libHD.so as SHVR calls it: one device, and a scheduler of its own that calls back once a millisecond.

#include "tests/stubs/hd_stub.h"

#include <chrono>
#include <cstddef>
#include <thread>

namespace {

HdStub stub;
std::thread scheduler;
std::atomic<bool> is_scheduled{false};
std::atomic<uint32_t (*)(void*)> callback{nullptr};
std::atomic<void*> callback_data{nullptr};
bool is_in_frame = false;
thread_local bool is_scheduler = false;
uint32_t pending = 0;

struct Error {
    uint32_t code;
    int32_t internal_code;
    uint32_t device;
};

void run()
{
    is_scheduler = true;
    while (stub.is_running) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (!is_scheduled) continue;
        ++stub.ticks;
        if (callback.load()(callback_data) == 0) is_scheduled = false;
    }
}

}  // namespace

extern "C" {

HdStub* stub_control()
{
    return &stub;
}

uint32_t hdInitDevice(const char*)
{
    ++stub.inits;
    pending = stub.init_error;
    return stub.is_there ? 0 : 0xffffffff;
}
void hdDisableDevice(uint32_t)
{
    ++stub.disables;
}
void hdMakeCurrentDevice(uint32_t) {}
void hdBeginFrame(uint32_t)
{
    is_in_frame = true;
}
void hdEndFrame(uint32_t)
{
    is_in_frame = false;
}
Error hdGetError()
{
    if (!is_scheduler) {
        const uint32_t code = pending;
        pending = 0;
        return {code, -28, 0};
    }
    const uint32_t code = stub.repeats_error ? stub.next_error.load() : stub.next_error.exchange(0);
    static thread_local bool was_told = false;  // a repeated error comes once a tick, not without end
    was_told = code != 0 && !was_told;
    return {was_told ? code : 0, -28, 0};
}
const char* hdGetErrorString(uint32_t)
{
    return "a text of the driver";
}
void hdEnable(uint32_t what)
{
    if (what == 0x4000) stub.is_force_on = true;
}
void hdDisable(uint32_t what)
{
    if (what == 0x4000) stub.is_force_on = false;
}
void hdGetDoublev(uint32_t what, double* values)
{
    const auto set = [&](const double* from, size_t count) {
        for (size_t i = 0; i < count; ++i) values[i] = from[i];
    };
    constexpr double BOX[]{-80.0, -60.0, -35.0, 80.0, 60.0, 35.0};
    // A quarter turn about z, by columns.
    constexpr double TURNED[]{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    switch (what) {
        case 0x2050:
            if (!is_in_frame) ++stub.unframed;
            for (size_t i = 0; i < 3; ++i) values[i] = stub.position_mm[i];
            break;
        case 0x2052: set(TURNED, 16); break;
        case 0x2551: set(BOX, 6); break;
        case 0x2603: *values = 3.0; break;
        case 0x2604: *values = 0.5; break;
        case 0x2605:
            values[0] = values[1] = 0.0;
            values[2] = stub.temperature;
            break;
        default: *values = 0.0;
    }
}
void hdGetIntegerv(uint32_t what, int32_t* value)
{
    *value = what == 0x2000 ? stub.buttons.load() : 0;
}
const char* hdGetString(uint32_t what)
{
    return what == 0x2501 ? "Stub Touch" : what == 0x2504 ? "S-0001" : nullptr;
}
void hdSetDoublev(uint32_t what, const double* values)
{
    if (what != 0x2700) return;
    if (!is_in_frame) ++stub.unframed;
    for (size_t i = 0; i < 3; ++i) stub.force_n[i] = values[i];
}
unsigned long hdScheduleAsynchronous(uint32_t (*function)(void*), void* data, uint16_t)
{
    callback_data = data;
    callback = function;
    is_scheduled = true;
    return 7;
}
void hdUnschedule(unsigned long)
{
    is_scheduled = false;
}
void hdStartScheduler()
{
    stub.is_running = true;
    scheduler = std::thread(run);
}
void hdStopScheduler()
{
    stub.is_running = false;
    if (scheduler.joinable()) scheduler.join();
}
uint32_t hdCheckCalibration()
{
    return stub.calibration;
}
void hdUpdateCalibration(uint32_t)
{
    ++stub.updates;
    stub.calibration = stub.calibration_after_update.load();
}
}
