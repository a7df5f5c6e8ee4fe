#pragma once
// The report of `shvr doctor`: devices, memory, display, folders, and the packages that provide what is missing. No
// function here fails: a part that cannot be determined states the reason.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/gpu/device_survey.h"
#include "haptics/devices/device_list.h"
#include "ui/display_report.h"

namespace shvr::cli {

/// Something that is missing or unusable, its purpose, and the remedy.
struct Missing {
    std::string what, for_what;
    std::string package;     ///< package of Debian and Ubuntu that provides it; empty if none does
    bool is_needed = false;  ///< whether SHVR cannot draw at all without it
};

struct FolderReport {
    std::string use;    ///< "preferences"
    std::string path;   ///< empty: the environment gives none
    std::string state;  ///< "can be written", or why not
    bool is_usable = false;
    std::optional<uint64_t> bytes_free;
};

struct MachineReport {
    std::string system, kernel, build;  ///< release of the distribution, kernel, compiler and build type
    std::vector<gpu::DeviceReport> devices;
    std::optional<size_t> chosen;         ///< index of the device that SHVR uses by default
    std::string why_no_device;            ///< reason why no device can be used; empty if one can
    uint64_t processors = 0;              ///< that this process may use
    uint64_t memory_bytes = 0;            ///< memory of the machine
    std::optional<uint64_t> limit_bytes;  ///< memory limit of this process's control group or address space, if lower
    ui::DisplayReport display;
    std::string display_names;  ///< variables of the environment, "DISPLAY=:0"
    std::vector<DeviceListing> styluses;
    std::vector<FolderReport> folders;
    std::vector<Missing> missing;
};
/// Takes up to a second. Main thread.
MachineReport survey_machine();

}  // namespace shvr::cli
