#pragma once
// The state that a test sets and reads in the stand-in for libHD.so. One device at a time.

#include <array>
#include <atomic>
#include <cstdint>

struct HdStub {
    // State of the device, set by tests.
    std::atomic<bool> is_there{true};
    std::atomic<uint32_t> init_error{0}, calibration{0x5000}, calibration_after_update{0x5000};
    std::atomic<double> position_mm[3]{};
    std::atomic<double> temperature{0.1};
    std::atomic<int32_t> buttons{0};
    std::atomic<uint32_t> next_error{0};  ///< returned once, by the next hdGetError of the scheduler
    std::atomic<bool> repeats_error{false};
    // Calls received.
    std::atomic<double> force_n[3]{};
    std::atomic<bool> is_force_on{false}, is_running{false};
    std::atomic<int> inits{0}, disables{0}, updates{0}, ticks{0}, unframed{0};
};

/// Type of the symbol `stub_control`, which returns the control block of this library.
using HdStubControl = HdStub* (*)();
