// shvr doctor: reports what the machine offers and lacks, on one page to attach to a bug report.

#include <iomanip>
#include <iostream>

#include "engine/base/text.h"
#include "tools/cli/about/machine_report.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

std::string mebibytes(uint64_t bytes)
{
    return sentence(bytes >> 20, " MiB");
}

void print_line(const std::string& name, const std::string& value)
{
    std::cout << "  " << std::left << std::setw(28) << name << value << '\n';
}

void print_devices(const MachineReport& report)
{
    std::cout << "\nVulkan devices\n";
    if (!report.why_no_device.empty()) std::cout << "  " << report.why_no_device << '\n';
    for (size_t i = 0; i < report.devices.size(); ++i) {
        const gpu::DeviceReport& device = report.devices[i];
        const bool is_chosen = report.chosen == i;
        print_line(sentence(i, is_chosen ? " (in use)" : ""), printable(device.row.name));
        print_line("", sentence(device.kind, ", Vulkan ", device.vulkan, ", ", mebibytes(device.bytes)));
        if (!device.driver.empty()) print_line("", "driver " + printable(device.driver));
        if (!device.why_unfit.empty()) print_line("", "cannot be used: " + device.why_unfit);
        for (const gpu::Need& need : device.needs)
            if (is_chosen || need.has < need.needed)
                print_line("", sentence(need.has, ' ', need.what, " (", need.needed, " needed)"));
        for (const gpu::DeviceReport::Option& option : device.options)
            if (is_chosen)
                print_line("", sentence(option.is_present ? "has " : "lacks ", option.name, ": ", option.gives));
    }
}

void print_machine(const MachineReport& report)
{
    std::cout << "shvr " << version_in_words() << ", " << report.build << "\n\nMachine\n";
    print_line("system", report.system.empty() ? "unknown" : report.system);
    print_line("kernel", report.kernel);
    print_line("processors", std::to_string(report.processors));
    print_line("memory", mebibytes(report.memory_bytes) +
                             (report.limit_bytes ? ", limited to " + mebibytes(*report.limit_bytes) : ""));
}

void print_surroundings(const MachineReport& report)
{
    std::cout << "\nDisplay\n";
    print_line("environment", report.display_names.empty() ? "names none" : report.display_names);
    if (!report.display.why_no_window.empty()) print_line("window", "cannot open: " + report.display.why_no_window);
    for (const std::string& screen : report.display.screens) print_line("screen", printable(screen));
    print_line("font", report.display.font.empty() ? "built in" : report.display.font);
    std::cout << "\nStyluses\n";
    for (const DeviceListing& stylus : report.styluses)
        print_line(printable(stylus.name), !stylus.why_unusable.empty() ? "cannot be used: " + stylus.why_unusable
                                           : stylus.has_force           ? "gives force where --allow-force is given"
                                                                        : "no force");
    std::cout << "\nFolders\n";
    for (const FolderReport& folder : report.folders) {
        print_line(folder.use, folder.path.empty() ? folder.state : printable(folder.path));
        if (!folder.path.empty())
            print_line("", folder.state + (folder.bytes_free ? ", " + mebibytes(*folder.bytes_free) + " free" : ""));
    }
}

void print_missing(const MachineReport& report)
{
    std::cout << "\nMissing\n";
    if (report.missing.empty()) std::cout << "  nothing\n";
    for (const Missing& each : report.missing)
        std::cout << "  " << printable(each.what) << "\n    " << (each.is_needed ? "needed" : "used") << " for "
                  << each.for_what << (each.package.empty() ? "" : "; package " + each.package) << '\n';
    std::cout.flush();
    if (!std::cout) fail("standard output: cannot be written");
}

Json json_of(const gpu::DeviceReport& device)
{
    Json limits = Json::object(), options = Json::object();
    for (const gpu::Need& need : device.needs) limits[need.what] = need.has;
    for (const gpu::DeviceReport::Option& option : device.options) options[option.name] = option.is_present;
    return {{"device", device.row.name}, {"driver", device.driver},       {"kind", device.kind},
            {"vulkan", device.vulkan},   {"bytes", device.bytes},         {"limits", limits},
            {"options", options},        {"why_unfit", device.why_unfit}, {"threads", device.threads}};
}

Json json_of(const MachineReport& report)
{
    Json devices = Json::array(), missing = Json::array(), folders = Json::array(), styluses = Json::array();
    for (const gpu::DeviceReport& device : report.devices) devices.push_back(json_of(device));
    for (const Missing& each : report.missing)
        missing.push_back({{"what", each.what},
                           {"for", each.for_what},
                           {"package", each.package.empty() ? Json(nullptr) : Json(each.package)},
                           {"needed", each.is_needed}});
    for (const FolderReport& folder : report.folders)
        folders.push_back({{"use", folder.use},
                           {"path", folder.path},
                           {"state", folder.state},
                           {"usable", folder.is_usable},
                           {"bytes_free", folder.bytes_free ? Json(*folder.bytes_free) : Json(nullptr)}});
    for (const DeviceListing& stylus : report.styluses)
        styluses.push_back({{"name", stylus.name}, {"force", stylus.has_force}, {"why_unusable", stylus.why_unusable}});
    const Json chosen = report.chosen ? devices[*report.chosen] : Json::object();
    const auto of_chosen = [&](const char* key) { return report.chosen ? chosen[key] : Json(nullptr); };
    return {{"device", of_chosen("device")},
            {"driver", of_chosen("driver")},
            {"limits", of_chosen("limits")},
            {"why_no_device", report.why_no_device},
            {"devices", devices},
            {"missing", missing},
            {"folders", folders},
            {"versions",
             {{"shvr", version_in_words()},
              {"build", report.build},
              {"system", report.system},
              {"kernel", report.kernel},
              {"vulkan", of_chosen("vulkan")}}},
            {"memory",
             {{"bytes", report.memory_bytes},
              {"limit", report.limit_bytes ? Json(*report.limit_bytes) : Json(nullptr)},
              {"processors", report.processors}}},
            {"display",
             {{"environment", report.display_names},
              {"why_no_window", report.display.why_no_window},
              {"screens", report.display.screens},
              {"font", report.display.font}}},
            {"styluses", styluses}};
}

void run_doctor(const Common& common)
{
    const MachineReport report = survey_machine();
    if (common.json) return print(json_of(report));
    print_machine(report);
    print_devices(report);
    print_surroundings(report);
    print_missing(report);
}

}  // namespace

void add_doctor(CLI::App& program)
{
    auto common = std::make_shared<Common>();
    CLI::App* command = program.add_subcommand("doctor", "Reports on this machine: devices, memory, folders, packages");
    add_output_options(*command, *common);
    command->footer(
        "It needs no device, display or home. Exit status 0, whatever is missing.\nExample:\n  shvr doctor --json");
    command->callback([common] { run_doctor(*common); });
}

}  // namespace shvr::cli
