#pragma once
// Haptic devices on HID, through hidapi (hidraw on Linux). What a device's reports hold is its profile's business.
// The application's thread.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "haptics/device.h"
#include "haptics/hid_profile.h"

namespace shvr {

/// Null where no device that a profile matches is plugged in. Fails where one is, but must not be opened (the udev rule
/// is missing) or is only recognised (its profile has no input report). It is found again after it was unplugged.
/// Forces reach it only where its profile is verified and `allow_force` says so.
std::unique_ptr<HapticDevice> open_hid_device(const std::vector<HidProfile>& profiles, bool allow_force);

struct HidListing {
    uint16_t vendor = 0, product = 0, usage_page = 0, usage = 0;
    std::string path, manufacturer, name, serial;
    std::string profile;  ///< name of the first that matches; empty: none
};
/// Every HID interface that is plugged in, haptic or not.
std::vector<HidListing> list_hid_devices(std::span<const HidProfile> profiles);

}  // namespace shvr
