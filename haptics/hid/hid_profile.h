#pragma once
// The layout of a HID device's reports, read from a file (assets/devices/*.json): supporting a new device requires a
// file, not a recompilation. assets/devices/README.md describes the format.
//
// Schema 1 supports one input report, with positions. Schema 2 supports several, distinguished by id and length, and
// devices that report speeds (rate control); such a device is at rest when it sends no reports.
//
// Loading is strict: unknown keys, fields that exceed their report and layouts without a source are refused with a
// one-sentence message. Any thread.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "haptics/device.h"

namespace shvr {

/// All quantities that a field can represent. A field's value is raw * scale + offset, in metres, seconds or newtons;
/// rotations are quaternions, and rates are fractions of full deflection, -1 ... 1.
enum class HidQuantity : uint8_t {
    // input
    buttons,
    calibrated,
    time,
    position_x,
    position_y,
    position_z,
    rotation_w,
    rotation_x,
    rotation_y,
    rotation_z,
    force_sequence,
    motor_temperature,
    rate_x,  ///< along the device's axes
    rate_y,
    rate_z,
    turn_x,  ///< about the same axes
    turn_y,
    turn_z,
    battery,
    // input and output
    sequence,
    // output
    enable,
    watchdog,
    force_x,
    force_y,
    force_z,
    // feature
    peak_force,
    usable_x,
    usable_y,
    usable_z,
    resolution,
    firmware,
    latency,
};

struct HidField {
    HidQuantity quantity = HidQuantity::buttons;
    uint32_t bit = 0;   ///< position of the field's lowest bit, from the first byte after the id; little endian
    uint32_t bits = 8;  ///< 1 ... 32
    bool is_signed = false;
    double scale = 1.0, offset = 0.0;
};

struct HidReport {
    uint8_t id = 0;       ///< 0: the device's reports have no id
    uint32_t length = 0;  ///< bytes after the id
    std::vector<HidField> fields;
    const HidField* find(HidQuantity quantity) const;
};

struct HidMatch {
    uint16_t vendor = 0, product = 0;
    uint16_t usage_page = 0, usage = 0;  ///< 0: any
};

/// Maps deflection to speed, in the direction of the deflection: gain * ((share - dead_zone) / (1 - dead_zone))^gamma.
struct HidRate {
    double speed = 0.1;       ///< speed in m/s in the device's workspace at full deflection
    double turn_speed = 1.5;  ///< rad/s at full deflection
    double gamma = 1.5;       ///< above 1: finer near the centre
    double dead_zone = 0.05;  ///< deflections below this fraction count as none
    uint32_t rest_ms = 200;   ///< a device that sends nothing for this long counts as at rest
};

struct HidProfile {
    std::string name;
    std::vector<HidMatch> matches;
    std::vector<HidReport> inputs;     ///< none: the device is only recognised
    std::vector<uint8_t> ignored_ids;  ///< reports without relevant data
    std::optional<HidReport> output, feature;
    std::optional<HidRate> rate;  ///< set: the device reports speeds, not positions
    /// Returns the field in any input report; null if no report has it.
    const HidField* find_input(HidQuantity quantity) const;
    glm::dmat3 axes{1.0};  ///< maps the device's axes to +x right, +y up, +z towards the user; a signed permutation
    DeviceCaps limits;
    uint32_t watchdog_ms = 0;  ///< time without a report after which the device drops its force; 0: it has no watchdog
    std::string provenance;    ///< source of the layout
    bool verified = false;     ///< tested on the real device; otherwise it gets no force
    std::string note;          ///< for owners of such a device
};

inline constexpr uint32_t MAX_REPORT_BYTES = 64;

/// `origin` names the text in error messages.
HidProfile parse_hid_profile(const std::string& text, const std::string& origin);
HidProfile load_hid_profile(const std::filesystem::path& file);
/// Loads all *.json files of a folder, sorted by name.
std::vector<HidProfile> load_hid_profiles(const std::filesystem::path& folder);

}  // namespace shvr
