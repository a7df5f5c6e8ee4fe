#pragma once
// 3D Systems' Touch and related devices through their maker's driver. The driver's scheduler calls this code a thousand
// times a second on a thread of its own; the servo exchanges latest values with that thread and never waits:
//
//   servo --Latest--> the driver's thread --Latest--> servo
//
// The driver's thread sets the force to zero when the servo has not written for 20 ms, when a motor is too warm, and
// after an error; a fault or a lost connection ends the device. While the driver runs, the HID node of a Touch is gone:
// this back end and `haptics/hid` exclude each other for one device.

#include <cstdint>
#include <memory>
#include <string>

#include "haptics/device.h"

namespace shvr {

struct OpenHapticsOptions {
    std::string library = "libHD.so";
    std::string device;  ///< name given in the driver's configuration; empty: the default one
    bool allow_force = false;
    bool may_calibrate = true;  ///< calibrates only in ways that need no user action
};

class OpenHaptics : public HapticDevice {
public:
    virtual std::string model() const = 0;
    virtual std::string serial() const = 0;
    /// Returns the warmest motor's temperature as a fraction of that at which the motor must rest. Any thread.
    virtual double motor_temperature() const noexcept = 0;
};

/// Returns null if the library is not installed. Fails with a sentence if there is no device, or if the device needs
/// calibration by hand. At most one device can be open at a time.
std::unique_ptr<OpenHaptics> open_openhaptics(const OpenHapticsOptions& options);

}  // namespace shvr
