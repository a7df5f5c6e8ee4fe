#include "tools/cli/about/machine_report.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "engine/base/assets.h"
#include "engine/base/error.h"
#include "engine/base/machine/machine.h"
#include "engine/base/text.h"

namespace shvr::cli {

namespace {

/// Returns the value of a line "KEY=value" of a file, without quotes; empty if there is no such line.
std::string value_in(const char* path, const std::string& key)
{
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(key + "=")) continue;
        std::string value = line.substr(key.size() + 1);
        std::erase(value, '"');
        return value;
    }
    return {};
}

std::string kernel_in_words()
{
    utsname name{};
    return ::uname(&name) == 0 ? sentence(name.sysname, ' ', name.release, ' ', name.machine) : "unknown";
}

FolderReport report_on_folder(const std::string& use, const std::filesystem::path& folder, bool is_written)
{
    FolderReport report{.use = use, .path = folder.string(), .state{}, .is_usable = false, .bytes_free{}};
    if (folder.empty()) {
        report.state = is_written ? "no folder is known; expected HOME in the environment" : "is not installed";
        return report;
    }
    std::error_code error;
    std::filesystem::path there = folder;  // the nearest existing ancestor; missing folders are created when needed
    while (!std::filesystem::exists(there, error) && there != there.parent_path()) there = there.parent_path();
    const bool allowed = ::access(there.c_str(), is_written ? W_OK | X_OK : R_OK | X_OK) == 0;
    const bool is_folder = std::filesystem::is_directory(there, error);
    report.is_usable = allowed && is_folder;
    report.state = !is_folder        ? sentence(there.string(), " is not a folder")
                   : !allowed        ? sentence(there.string(), is_written ? " cannot be written" : " cannot be read")
                   : there == folder ? (is_written ? "can be written" : "can be read")
                                     : "will be made when needed";
    const std::filesystem::space_info space = std::filesystem::space(there, error);
    if (!error) report.bytes_free = space.available;
    return report;
}

bool is_program(const std::string& name)
{
    const char* const path = std::getenv("PATH");
    std::string_view rest = path ? path : "";
    while (!rest.empty()) {
        const size_t end = rest.find(':');
        const std::filesystem::path file = std::filesystem::path(rest.substr(0, end)) / name;
        if (::access(file.c_str(), X_OK) == 0) return true;
        rest = end == rest.npos ? "" : rest.substr(end + 1);
    }
    return false;
}

void survey_vulkan(MachineReport& report)
{
    try {
        report.devices = gpu::survey_devices();
        report.chosen = gpu::default_device(report.devices);
    } catch (const Error& error) {
        report.why_no_device = error.what();
    }
}

std::string display_names()
{
    std::string names;
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "XDG_SESSION_TYPE"})
        if (const char* const value = std::getenv(name))
            names += sentence(names.empty() ? "" : ", ", name, '=', printable(value));
    return names;
}

void survey_folders(MachineReport& report)
{
    std::error_code unknown;
    report.folders = {report_on_folder("preferences", config_folder(), true),
                      report_on_folder("cache of kernels", cache_folder(), true),
                      report_on_folder("temporary files", std::filesystem::temp_directory_path(unknown), true),
                      report_on_folder("transfer functions", asset_folder("transfer_functions"), false),
                      report_on_folder("descriptions of styluses", asset_folder("devices"), false),
                      report_on_folder("examples", asset_folder("examples"), false)};
}

void list_missing(MachineReport& report)
{
    std::vector<Missing>& missing = report.missing;
    if (!report.chosen)
        missing.push_back({"a usable Vulkan device", "drawing, painting and the window", "mesa-vulkan-drivers", true});
    if (!report.display.why_no_window.empty())
        missing.push_back(
            {"a display: " + report.display.why_no_window, "shvr view; all other commands work", "", false});
    if (report.display.font.empty())
        missing.push_back({"a font for the window", "letters beyond ASCII in the window", "fonts-dejavu-core", false});
    if (!gpu::validation_is_installed())
        missing.push_back({"the Vulkan validation layer", "SHVR_VALIDATION=1", "vulkan-validationlayers", false});
    if (!is_program("dot")) missing.push_back({"the program dot", "shvr profile --graph with .svg", "graphviz", false});
    if (!is_program("ffmpeg"))
        missing.push_back({"the program ffmpeg", "shvr render --movie with .webm or .mp4", "ffmpeg", false});
    if (!is_program("xdg-open"))
        missing.push_back({"the program xdg-open", "Help > User manual in the window", "xdg-utils", false});
    for (const FolderReport& folder : report.folders)
        if (!folder.is_usable)
            missing.push_back({sentence("the folder of ", folder.use, ": ", folder.state), folder.use, "", false});
    for (const DeviceListing& stylus : report.styluses)
        if (!stylus.why_unusable.empty())
            missing.push_back({sentence("access to ", stylus.name, ": ", stylus.why_unusable), "touch", "", false});
}

}  // namespace

MachineReport survey_machine()
{
    MachineReport report;
    report.system = value_in("/etc/os-release", "PRETTY_NAME");
    report.kernel = kernel_in_words();
    report.build = sentence("g++ " __VERSION__ ", " SHVR_BUILD_TYPE);
    survey_vulkan(report);
    report.processors = uint64_t(processors_allowed());
    report.memory_bytes = uint64_t(::sysconf(_SC_PHYS_PAGES)) * uint64_t(::sysconf(_SC_PAGE_SIZE));
    report.limit_bytes = memory_limit();
    report.display = ui::survey_display();
    report.display_names = display_names();
    const std::filesystem::path profiles = asset_folder("devices");
    try {
        report.styluses =
            list_devices({.profiles = profiles.empty() ? std::vector<HidProfile>() : load_hid_profiles(profiles)});
    } catch (const Error& error) {
        report.missing.push_back({sentence("descriptions of styluses: ", error.what()), "touch", "", false});
    }
    survey_folders(report);
    list_missing(report);
    return report;
}

}  // namespace shvr::cli
