// shvr haptics devices: lists the haptic devices that are plugged in and how they can be used; or records raw reports
// of a device, for an analysis of their layout.

#include <chrono>
#include <iostream>

#include "engine/base/assets.h"
#include "engine/base/text.h"
#include "haptics/devices/device_list.h"
#include "haptics/hid/hid_recording.h"
#include "tools/cli/cli.h"
#include "tools/cli/haptics_report.h"

namespace shvr::cli {

namespace {

struct DevicesCommandOptions {
    Common common;
    std::string record, output;
    double seconds = 10.0;
};

std::vector<HidProfile> known_profiles()
{
    const std::filesystem::path folder = asset_folder("devices");
    return folder.empty() ? std::vector<HidProfile>() : load_hid_profiles(folder);
}

std::string in_words(const DeviceListing& device)
{
    std::string text = device.name;
    if (!device.serial.empty()) text += ", " + device.serial;
    if (!device.connection.empty()) text += " (" + device.connection + ")";
    if (!device.why_unusable.empty()) return text + ": cannot be used: " + device.why_unusable;
    if (device.has_force) return text + ": gives force where --allow-force is given";
    return text + ": no force" + (device.why_no_force.empty() ? "" : ", for " + device.why_no_force);
}

void list(const Common& common)
{
    const std::vector<HidProfile> profiles = known_profiles();
    Json devices = Json::array(), known = Json::array();
    const std::vector<DeviceListing> listings = list_devices({.profiles = profiles});
    for (const DeviceListing& device : listings)
        devices.push_back({{"id", device.id},
                           {"name", device.name},
                           {"serial", device.serial},
                           {"connection", device.connection},
                           {"force", device.has_force},
                           {"why_no_force", device.why_no_force},
                           {"why_unusable", device.why_unusable}});
    for (const HidProfile& profile : profiles)
        known.push_back({{"name", profile.name},
                         {"reads", !profile.inputs.empty()},
                         {"force", profile.verified && profile.output.has_value()},
                         {"note", profile.note}});
    if (common.json) return print({{"devices", devices}, {"profiles", known}, {"models", {"touch"}}});
    for (const DeviceListing& device : listings) std::cout << in_words(device) << '\n';
    for (const HidProfile& profile : profiles)
        std::cout << "known: " << profile.name
                  << (profile.inputs.empty()               ? " (recognised only)"
                      : profile.verified && profile.output ? " (gives force)"
                                                           : " (is read; gives no force)")
                  << '\n';
    std::cout.flush();
    if (!std::cout) fail("standard output: cannot be written");
}

void record(const DevicesCommandOptions& options)
{
    if (options.output.empty()) throw UsageError("--record is given without -o; expected the file for the reports");
    LongWork work(options.common.quiet);
    static_cast<void>(work.begin("recording " + options.record));
    const auto begin = std::chrono::steady_clock::now();
    const size_t reports = record_hid_device(options.record, options.output, options.seconds, [&](size_t so_far) {
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        work.show(seconds / options.seconds, sentence(so_far, " reports"), options.seconds - seconds);
        return !work.is_asked_to_stop();
    });
    clear_progress();
    if (options.common.json) return print({{"reports", reports}, {"written", options.output}});
    say(options.common, sentence(options.output, ": ", reports, " reports of ", options.record));
}

}  // namespace

void add_haptics_devices(CLI::App& haptics)
{
    auto options = std::make_shared<DevicesCommandOptions>();
    CLI::App* command = haptics.add_subcommand("devices", "Lists haptic devices, or records the reports of one");
    command->add_option("--record", options->record, "Writes the raw reports of a HID device: 2988:0304, /dev/hidraw3");
    command->add_option("--seconds", options->seconds, "Of a recording, at most")->check(number_between(0.1, 900.0));
    command->add_option("-o,--output", options->output, "File for the reports; it must not exist");
    add_output_options(*command, options->common);
    command->footer("Example:\n  shvr haptics devices --json");
    command->callback([options] { options->record.empty() ? list(options->common) : record(*options); });
}

}  // namespace shvr::cli
