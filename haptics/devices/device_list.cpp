#include "haptics/devices/device_list.h"

#include <unistd.h>

#include <algorithm>
#include <functional>

#include "engine/base/error.h"
#include "haptics/openhaptics/hd_library.h"

namespace shvr {
namespace {

const std::string HID = "hid:", INVERSE3 = "inverse3:", OPENHAPTICS = "openhaptics:", MOUSE = "mouse";

Inverse3Options inverse3_of(const DeviceOptions& options)
{
    Inverse3Options inverse3 = options.inverse3;
    inverse3.allow_force = options.allow_force;
    return inverse3;
}

OpenHapticsOptions openhaptics_of(const DeviceOptions& options)
{
    OpenHapticsOptions openhaptics = options.openhaptics;
    openhaptics.allow_force = options.allow_force;
    return openhaptics;
}

void list_hid(const DeviceOptions& options, std::vector<DeviceListing>& rows)
{
    for (const HidListing& device : list_hid_devices(options.profiles)) {
        const auto profile = std::ranges::find(options.profiles, device.profile, &HidProfile::name);
        const bool is_listed = std::ranges::find(rows, HID + device.path, &DeviceListing::id) != rows.end();
        if (device.profile.empty() || profile == options.profiles.end() || is_listed) continue;
        rows.push_back(listing_of(device, *profile, ::access(device.path.c_str(), R_OK | W_OK) == 0));
    }
}

void list_inverse3(const DeviceOptions& options, std::vector<DeviceListing>& rows)
{
    const Inverse3Found found = find_inverse3(options.inverse3);
    if (!found.is_service) return;
    rows.push_back({.kind = DeviceKind::inverse3,
                    .id = INVERSE3 + found.device_id,
                    .name = "Haply Inverse3",
                    .serial = found.device_id,
                    .connection = sentence("service on port ", options.inverse3.port),
                    .has_force = true,
                    .why_unusable = found.trouble});
}

void list_openhaptics(const DeviceOptions& options, std::vector<DeviceListing>& rows)
{
    DeviceListing row{.kind = DeviceKind::openhaptics,
                      .id = OPENHAPTICS,
                      .name = "3D Systems device (OpenHaptics)",
                      .connection = options.openhaptics.library,
                      .has_force = true};
    try {
        if (!load_hd_library(options.openhaptics.library)) return;
    } catch (const Error& error) {
        row.why_unusable = error.what();
    }
    rows.push_back(row);
}

}  // namespace

DeviceListing listing_of(const HidListing& device, const HidProfile& profile, bool can_open)
{
    DeviceListing row{.kind = DeviceKind::hid,
                      .id = HID + device.path,
                      .name = device.name.empty() ? profile.name : device.name,
                      .serial = device.serial,
                      .connection = device.path,
                      .has_force = profile.verified && profile.output.has_value()};
    if (!profile.output)
        row.why_no_force = "its profile has no output report";
    else if (!profile.verified)
        row.why_no_force = "its profile is not verified";
    if (profile.inputs.empty())
        row.why_unusable = profile.note.empty() ? "its profile does not describe its reports" : profile.note;
    else if (!can_open)
        row.why_unusable = "it cannot be opened: the rule tools/udev/70-shvr-haptics.rules is not installed";
    return row;
}

std::vector<DeviceListing> list_devices(const DeviceOptions& options)
{
    std::vector<DeviceListing> rows;
    list_hid(options, rows);
    list_inverse3(options, rows);
    list_openhaptics(options, rows);
    rows.push_back({.kind = DeviceKind::mouse,
                    .id = MOUSE,
                    .name = "Mouse",
                    .connection = "window",
                    .why_no_force = "it has no motors: the probe itself is drawn along"});
    return rows;
}

std::unique_ptr<HapticDevice> open_device(const DeviceOptions& options, const std::string& id)
{
    if (id == MOUSE) return nullptr;
    std::unique_ptr<HapticDevice> device;
    if (id.starts_with(HID)) {
        device = open_hid_device(options.profiles, options.allow_force, id.substr(HID.size()));
    } else if (id.starts_with(INVERSE3)) {
        Inverse3Options inverse3 = inverse3_of(options);
        inverse3.device_id = id.substr(INVERSE3.size());
        device = open_inverse3(inverse3);
    } else if (id == OPENHAPTICS) {
        device = open_openhaptics(openhaptics_of(options));
    }
    if (!device) fail("haptic device ", id, ": is not there; expected the id of a device that is listed");
    return device;
}

std::unique_ptr<HapticDevice> open_first_device(const DeviceOptions& options)
{
    const std::vector<std::function<std::unique_ptr<HapticDevice>()>> ways{
        [&] { return open_hid_device(options.profiles, options.allow_force); },
        [&]() -> std::unique_ptr<HapticDevice> { return open_inverse3(inverse3_of(options)); },
        [&]() -> std::unique_ptr<HapticDevice> { return open_openhaptics(openhaptics_of(options)); }};
    std::string first_trouble;
    for (const auto& open : ways) {
        try {
            if (std::unique_ptr<HapticDevice> device = open()) return device;
        } catch (const Error& error) {
            // If a Touch's HID layout is unknown, the maker's driver (OpenHaptics) may be able to open the device.
            if (first_trouble.empty()) first_trouble = error.what();
        }
    }
    if (!first_trouble.empty()) fail(first_trouble);
    return nullptr;
}

}  // namespace shvr
