#pragma once
// Lists and opens the haptic devices of all back ends. Call from the application's thread.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "haptics/device.h"
#include "haptics/hid/hid_device.h"
#include "haptics/hid/hid_profile.h"
#include "haptics/inverse3/inverse3_link.h"
#include "haptics/openhaptics/openhaptics_device.h"

namespace shvr {

enum class DeviceKind : uint8_t { hid, inverse3, openhaptics, mouse };

struct DeviceListing {
    DeviceKind kind = DeviceKind::mouse;
    std::string id;  ///< id for `open_device`; stable as long as the device stays plugged in
    std::string name, serial;
    std::string connection;  ///< "/dev/hidraw3", "service on port 10001", "libHD.so"
    bool has_force = false;  ///< the device can exert forces once they are allowed
    std::string why_no_force;
    std::string why_unusable;  ///< empty: it can be opened
};

struct DeviceOptions {
    std::vector<HidProfile> profiles;
    bool allow_force = false;
    Inverse3Options inverse3;        ///< its `allow_force` is replaced by the member above
    OpenHapticsOptions openhaptics;  ///< its `allow_force` is ignored as well
};

/// Lists HID devices that match a profile, the Inverse3's service, OpenHaptics if it is installed, and last the mouse,
/// which is always present. Opens no device. Waits for the Inverse3's service for about 0.3 s at most.
std::vector<DeviceListing> list_devices(const DeviceOptions& options);

/// Returns the row of a HID device. `can_open`: whether the current user has permission to read and write the device.
DeviceListing listing_of(const HidListing& device, const HidProfile& profile, bool can_open);

/// Opens the device with a listing's id; returns null for the mouse. Fails with a reason if it is gone or unusable.
std::unique_ptr<HapticDevice> open_device(const DeviceOptions& options, const std::string& id);

/// Opens the first usable device of HID, Inverse3 and OpenHaptics. Returns null if no device is present. If devices are
/// present but none can be used, fails with the reason of the first device.
std::unique_ptr<HapticDevice> open_first_device(const DeviceOptions& options);

}  // namespace shvr
