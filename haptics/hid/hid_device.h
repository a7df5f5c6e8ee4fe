#pragma once
// Haptic devices on HID, through hidapi (hidraw on Linux). A profile describes the layout of a device's reports. The
// application's thread.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "haptics/device.h"
#include "haptics/hid/hid_profile.h"

namespace shvr {

/// Returns null if no plugged-in device matches a profile. Fails if a device is plugged in but cannot be opened (the
/// udev rule is missing) or is only recognised (its profile has no input report). A device that is unplugged later is
/// reopened when it returns. `path`: a listing's path; empty: the first device of the first profile that matches.
/// Forces reach the device only if its profile is verified and `allow_force` is set.
std::unique_ptr<HapticDevice> open_hid_device(const std::vector<HidProfile>& profiles, bool allow_force,
                                              const std::string& path = {});

struct HidListing {
    uint16_t vendor = 0, product = 0, usage_page = 0, usage = 0;
    std::string path, manufacturer, name, serial;
    std::string profile;  ///< name of the first matching profile; empty: none
};
/// Returns every HID interface plugged in, haptic or not.
std::vector<HidListing> list_hid_devices(std::span<const HidProfile> profiles);

}  // namespace shvr
