#pragma once
// Read-only view of the haptic device in the user's hand, and texts that describe its state. Pure; any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/workbench/models/messages.h"
#include "engine/workbench/models/preferences.h"
#include "engine/workbench/touch/device_tap.h"
#include "haptics/devices/device_list.h"

namespace shvr::ui {

struct HandView {
    std::vector<DeviceListing> devices;  ///< devices last found
    bool has_looked = false, is_looking = false;
    std::string in_use;   ///< id of the open device; empty: no device is open, and the mouse moves the probe
    std::string opening;  ///< id of the device being opened; empty: none
    std::string name = "mouse", serial, connection;
    std::string trouble;       ///< fault of the open device, or why the last device could not be opened
    bool is_puck = false;      ///< the device reports speeds
    bool moves_probe = false;  ///< a device moves the probe; false: the mouse does
    bool is_realtime = false;  ///< whether the running servo has realtime priority
    bool is_let_go = false, is_grabbing = false;
    TapState tap;
    std::optional<double> recorded_s;  ///< duration of the recording under way
    std::filesystem::path recording;   ///< file of the current recording, or of the last one; empty: none
};

/// Returns "Touch (serial 1234)".
std::string name_in_words(const std::string& name, const std::string& serial);
/// Describes a device in a list: "moves the probe", "can push the hand", or why it cannot be used.
std::string state_in_words(const DeviceListing& device, const HandView& hand);

struct Finding {
    Weight weight = Weight::done;
    std::string text;
    bool operator==(const Finding&) const = default;
};
/// Describes the servo's state with causes, one sentence each, most severe first; omits force if guidance is off.
std::vector<Finding> findings_of(const HandView& hand, const ServoState& servo, bool is_guided);

/// Describes the servo's timing in a text such as "60000 steps, 0.02 % of them late".
std::string rhythm_in_words(const ServoState& servo);
/// Returns whether the servo has realtime priority and, if it has not, how the user can allow it.
Finding realtime_in_words(bool is_realtime, uint64_t allowed_priority);
/// Returns the limit of this system: RLIMIT_RTPRIO.
uint64_t allowed_realtime_priority();
/// Returns "cool", "warm" or "hot" with the share of the motors' continuous limit; empty for devices without motors.
std::string heat_in_words(double heat, const DeviceCaps& caps);

/// Returns the bars of a plot, oldest first.
std::vector<float> plot_of(const TapState& tap);

}  // namespace shvr::ui
