#pragma once
// Every haptic device of every back end: listed, chosen, opened. The application's thread.

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
    std::string id;  ///< for `open_device`; the same as long as it stays plugged in
    std::string name, serial;
    std::string connection;  ///< "/dev/hidraw3", "service on port 10001", "libHD.so"
    bool has_force = false;  ///< it would give one if that were allowed
    std::string why_no_force;
    std::string why_unusable;  ///< empty: it can be opened
};

struct DeviceOptions {
    std::vector<HidProfile> profiles;
    bool allow_force = false;
    Inverse3Options inverse3;        ///< its `allow_force` is that of above
    OpenHapticsOptions openhaptics;  ///< likewise
};

/// HID devices that a profile knows, the Inverse3's service, OpenHaptics where it is installed, and the mouse, which is
/// always there and last. Opens none of them; waits for the service for some 0.3 s at most.
std::vector<DeviceListing> list_devices(const DeviceOptions& options);

/// The row of a HID device. `can_open`: whether the system lets this person read and write it.
DeviceListing listing_of(const HidListing& device, const HidProfile& profile, bool can_open);

/// Opens the device with the id of a listing; null for the mouse. Fails with a sentence if it is gone or unusable.
std::unique_ptr<HapticDevice> open_device(const DeviceOptions& options, const std::string& id);

/// The first device of HID, Inverse3 and OpenHaptics that can be used; null if none is there. Fails with the first
/// sentence if there are some, and none can be used.
std::unique_ptr<HapticDevice> open_first_device(const DeviceOptions& options);

}  // namespace shvr
