#include "haptics/hid/hid_device.h"

#include <hidapi/hidapi.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <utility>

#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "haptics/hid/hid_link.h"
#include "haptics/hid/hid_recording.h"

namespace shvr {
namespace {

/// hidapi's global functions share state (the last error, udev's context), so calls must be serialized across threads.
std::mutex& hidapi_mutex()
{
    static std::mutex mutex;
    return mutex;
}

/// Returns the name as printable ASCII; devices may report any characters.
std::string printable(const wchar_t* text)
{
    std::string result;
    for (; text && *text; ++text) result += *text >= 0x20 && *text < 0x7f ? char(*text) : '?';
    return result;
}

struct CloseDevice {
    void operator()(hid_device* device) const { hid_close(device); }
};

class HidapiPort : public HidPort {
public:
    explicit HidapiPort(hid_device* device) : device_(device) {}
    int read(std::span<uint8_t> report, int timeout_ms) override
    {
        return hid_read_timeout(device_.get(), report.data(), report.size(), timeout_ms);
    }
    bool write(std::span<const uint8_t> report) override
    {
        return hid_write(device_.get(), report.data(), report.size()) >= 0;
    }
    int read_feature(uint8_t id, std::span<uint8_t> report) override
    {
        report[0] = id;
        return std::max(hid_get_feature_report(device_.get(), report.data(), report.size()), 0);
    }

private:
    std::unique_ptr<hid_device, CloseDevice> device_;
};

bool matches(const HidMatch& match, const HidListing& device)
{
    return match.vendor == device.vendor && match.product == device.product &&
           (match.usage_page == 0 || match.usage_page == device.usage_page) &&
           (match.usage == 0 || match.usage == device.usage);
}

bool matches(const HidProfile& profile, const HidListing& device)
{
    return std::any_of(profile.matches.begin(), profile.matches.end(),
                       [&](const HidMatch& match) { return matches(match, device); });
}

/// "2988:0304"
std::string ids_of(const HidListing& device)
{
    std::string text;
    for (const uint16_t id : {device.vendor, device.product}) {
        if (!text.empty()) text += ':';
        for (int shift = 12; shift >= 0; shift -= 4) text += "0123456789abcdef"[(id >> shift) & 15];
    }
    return text;
}

/// "Touch (2988:0304 at /dev/hidraw3)"
std::string described(const HidListing& device)
{
    return sentence(device.name.empty() ? "device" : device.name, " (", ids_of(device), " at ", device.path, ")");
}

struct Opened {
    std::unique_ptr<HidPort> port;
    std::string reason;  ///< hidapi's message if there is no port
};
Opened open_port(const std::string& path)
{
    const std::lock_guard lock(hidapi_mutex());
    if (hid_device* device = hid_open_path(path.c_str())) return {std::make_unique<HidapiPort>(device), {}};
    return {nullptr, printable(hid_error(nullptr))};
}

/// Returns the device's report descriptor from the system, since hidapi 0.13 has no call for it; empty if the system
/// does not expose the descriptor.
std::vector<uint8_t> descriptor_of(const std::string& path)
{
    const std::filesystem::path file =
        "/sys/class/hidraw" / std::filesystem::path(path).filename() / "device/report_descriptor";
    std::ifstream stream(file, std::ios::binary);
    std::vector<uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
    bytes.resize(std::min<size_t>(bytes.size(), 4096));
    return bytes;
}

/// Returns the first plugged-in device that the profile matches.
std::optional<HidListing> find_device(const HidProfile& profile)
{
    for (HidListing& device : list_hid_devices({})) {
        if (matches(profile, device)) return std::move(device);
    }
    return std::nullopt;
}

}  // namespace

std::vector<HidListing> list_hid_devices(std::span<const HidProfile> profiles)
{
    std::vector<HidListing> devices;
    {
        const std::lock_guard lock(hidapi_mutex());
        const std::unique_ptr<hid_device_info, decltype(&hid_free_enumeration)> found(hid_enumerate(0, 0),
                                                                                      hid_free_enumeration);
        for (const hid_device_info* info = found.get(); info; info = info->next) {
            devices.push_back({.vendor = info->vendor_id,
                               .product = info->product_id,
                               .usage_page = info->usage_page,
                               .usage = info->usage,
                               .path = info->path,
                               .manufacturer = printable(info->manufacturer_string),
                               .name = printable(info->product_string),
                               .serial = printable(info->serial_number)});
        }
    }
    for (HidListing& device : devices) {
        const auto profile = std::ranges::find_if(profiles, [&](const HidProfile& p) { return matches(p, device); });
        if (profile != profiles.end()) device.profile = profile->name;
    }
    return devices;
}

size_t record_hid_device(const std::string& device, const std::filesystem::path& file, double most_s,
                         const std::function<bool(size_t)>& goes_on)
{
    if (std::filesystem::exists(file)) fail(file.string(), ": exists; expected the name of a new file");
    const std::vector<HidListing> devices = list_hid_devices({});
    const auto found = std::ranges::find_if(
        devices, [&](const HidListing& each) { return each.path == device || ids_of(each) == device; });
    if (found == devices.end())
        fail(device, ": is not plugged in; expected ids as in 2988:0304, or a path as in /dev/hidraw3, of one of ",
             devices.size(), " HID devices");
    const Opened opened = open_port(found->path);
    if (!opened.port)
        fail(described(*found), ": cannot be opened: ", opened.reason, "; expected permission to read it, as the rule ",
             "tools/udev/70-shvr-haptics.rules grants");
    HidRecording recording{.vendor = found->vendor,
                           .product = found->product,
                           .name = found->name,
                           .descriptor = descriptor_of(found->path)};
    record_reports(*opened.port, most_s, goes_on, recording);
    if (recording.reports.empty()) fail(described(*found), ": sent no report; expected some when it is moved");
    const std::string text = text_of(recording);
    write_file_atomically(file, std::as_bytes(std::span(text)));
    return recording.reports.size();
}

std::unique_ptr<HapticDevice> open_hid_device(const std::vector<HidProfile>& profiles, bool allow_force,
                                              const std::string& path)
{
    std::vector<HidListing> devices = list_hid_devices({});
    if (!path.empty()) std::erase_if(devices, [&](const HidListing& device) { return device.path != path; });
    const auto device_of = [&](const HidProfile& profile) {
        return std::ranges::find_if(devices, [&](const HidListing& device) { return matches(profile, device); });
    };
    for (const HidProfile& profile : profiles) {
        const auto device = device_of(profile);
        if (profile.inputs.empty() || device == devices.end()) continue;
        Opened opened = open_port(device->path);
        if (!opened.port) {
            fail(described(*device), ": cannot be opened: ", opened.reason,
                 "; expected permission to read and write it, ",
                 "which the rule tools/udev/70-shvr-haptics.rules grants");
        }
        const auto reopen = [profile]() -> std::unique_ptr<HidPort> {
            const std::optional<HidListing> found = find_device(profile);
            return found ? open_port(found->path).port : nullptr;
        };
        return make_hid_link(profile, std::move(opened.port), reopen, {.allow_force = allow_force, .realtime = true});
    }
    // Profiles that only recognise a device come last, since another profile may describe the device's layout.
    for (const HidProfile& profile : profiles) {
        if (const auto device = device_of(profile); device != devices.end())
            fail(described(*device), ": is recognised as ", profile.name,
                 ", but its profile does not describe its reports; ",
                 profile.note.empty() ? "expected a profile with an input report" : profile.note);
    }
    return nullptr;
}

}  // namespace shvr
