#pragma once
// Raw reports with their arrival times, so that the owner of a device whose layout is not public can contribute a
// recording. Nothing is written to the device. Each line of the file is JSON: the first describes the device, and each
// other line is a report:
//
//     {"format":"shvr_hid_reports","version":1,"vendor":"0x2988","product":"0x0304","name":"Touch","descriptor":"06"}
//     {"t_us":1042,"bytes":"01a3ff"}
//
// Times are microseconds since the recording began, and never decrease; bytes begin with the report's id if the device
// numbers its reports. The descriptor is the device's own description of its reports, if the system exposes it. No
// serial number is stored.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "haptics/hid/hid_link.h"

namespace shvr {

struct HidRecordedReport {
    uint64_t t_us = 0;
    std::vector<uint8_t> bytes;
};

struct HidRecording {
    uint16_t vendor = 0, product = 0;
    std::string name;
    std::vector<uint8_t> descriptor;  ///< empty: not known
    std::vector<HidRecordedReport> reports;
};

inline constexpr size_t MAX_RECORDED_REPORT_BYTES = 1024;
inline constexpr size_t MAX_RECORDED_REPORTS = 1'000'000;  ///< maximum number of reports: a quarter of an hour at 1 kHz

/// Adds reports to `recording` until `most_s` seconds have passed, the device is gone or `goes_on` returns false;
/// `goes_on` is called every 20 ms, with the number of reports so far. Returns false if the device was removed.
bool record_reports(HidPort& port, double most_s, const std::function<bool(size_t)>& goes_on, HidRecording& recording);

/// Records a device into `file`, which must not exist. `device`: USB ids ("2988:0304"; the first device with them) or a
/// path ("/dev/hidraw3"). Returns the number of reports. Fails with a sentence if there is no such device, it cannot be
/// opened, or it sent nothing.
size_t record_hid_device(const std::string& device, const std::filesystem::path& file, double most_s,
                         const std::function<bool(size_t)>& goes_on);

std::string text_of(const HidRecording& recording);
/// `origin` names the text in error messages.
HidRecording parse_hid_recording(const std::string& text, const std::string& origin);
HidRecording load_hid_recording(const std::filesystem::path& file);

}  // namespace shvr
