#pragma once
// Connects the servo to a HID device. hid_write may block for a millisecond and hid_read for longer, so each has its
// own thread; the servo exchanges latest values with both threads and never waits:
//
//   port -> reader thread --Latest--> read()      write() --Latest--> writer thread -> port
//
// For a device that reports speeds, the link integrates the position: each read() advances the position while the
// device is present, and a force moves it as with the mouse. Without reports, the device counts as at rest.
//
// The reader drains the queue, since kernels keep the OLDEST reports after a stall, and keeps the newest report. When
// the port is gone, read() returns `lost`; the reader tries to reopen the port every 15 ms, and then reads the device's
// limits again. The writer's last report switches the force off.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "haptics/device.h"
#include "haptics/hid/hid_profile.h"

namespace shvr {

/// The interface to hidapi, which tests replace by a fake. One thread may read while another writes; the destructor
/// closes the port.
class HidPort {
public:
    virtual ~HidPort() = default;
    /// Reads one report and returns its length in bytes: 0 if none arrived in time, -1 if the device is gone.
    virtual int read(std::span<uint8_t> report, int timeout_ms) = 0;
    /// Returns false if the device is gone.
    virtual bool write(std::span<const uint8_t> report) = 0;
    /// Reads the feature report with the id `id`, whose first byte is the id, and returns the report's length in bytes;
    /// 0 if there is none.
    virtual int read_feature(uint8_t id, std::span<uint8_t> report) = 0;
};

/// Opens the port; returns null while the device is absent.
using HidOpener = std::function<std::unique_ptr<HidPort>()>;

struct HidLinkOptions {
    bool allow_force = false;        ///< takes effect only if the profile is verified
    bool realtime = false;           ///< SCHED_FIFO for both threads, if the system allows it
    uint64_t (*now_ns)() = nullptr;  ///< clock for rate control; null: the steady clock
};

/// `port` is open, and `profile` has an input report. `reopen` is called on the reader's thread. Force reports have the
/// enable flag off unless force is allowed; a device with an unverified layout gets no output reports.
std::unique_ptr<HapticDevice> make_hid_link(const HidProfile& profile, std::unique_ptr<HidPort> port, HidOpener reopen,
                                            const HidLinkOptions& options);

}  // namespace shvr
