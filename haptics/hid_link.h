#pragma once
// A haptic device behind a pair of pipes. hid_write may block for a millisecond and hid_read for longer, so each has a
// thread; the servo exchanges latest values with them and never waits:
//
//   port -> reader thread --Latest--> read()      write() --Latest--> writer thread -> port
//
// The reader drains what waits (kernels keep the OLDEST reports after a stall) and keeps the newest. When the port is
// gone read() says so, and the reader tries to open it again every 50 ms. The writer's last report switches the force
// off.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "haptics/device.h"
#include "haptics/hid_profile.h"

namespace shvr {

/// The seam to hidapi, and to the fakes of the tests. One thread reads while another writes; closing is destruction.
class HidPort {
public:
    virtual ~HidPort() = default;
    /// Bytes of one report, 0 where none came within the time, -1 where the device is gone.
    virtual int read(std::span<uint8_t> report, int timeout_ms) = 0;
    /// False where the device is gone.
    virtual bool write(std::span<const uint8_t> report) = 0;
    /// Bytes of the feature report with that id, which is the first; 0 where there is none.
    virtual int read_feature(uint8_t id, std::span<uint8_t> report) = 0;
};

/// Null where nothing is there (yet).
using HidOpener = std::function<std::unique_ptr<HidPort>()>;

struct HidLinkOptions {
    bool allow_force = false;  ///< and only if the profile is verified
    bool realtime = false;     ///< SCHED_FIFO for both threads, where the system lets us
};

/// `port` is open and its profile has an input report. `reopen` is called on the reader's thread.
/// Force reports are written with the enable flag off unless force is allowed; a layout that is not verified gets none.
std::unique_ptr<HapticDevice> make_hid_link(const HidProfile& profile, std::unique_ptr<HidPort> port, HidOpener reopen,
                                            const HidLinkOptions& options);

}  // namespace shvr
