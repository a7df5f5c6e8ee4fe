#pragma once
// What there is to see of the hand and its device, and its states in words of those who use it. Pure; any thread.

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
    std::vector<DeviceListing> devices;  ///< as last found
    bool has_looked = false, is_looking = false;
    std::string in_use;   ///< id of the device that is open; empty: none is, and the mouse moves the probe
    std::string opening;  ///< id of the one that is being opened; empty: none
    std::string name = "mouse", serial, connection;
    std::string trouble;       ///< of the device that is open, or why the last one could not be opened
    bool is_puck = false;      ///< it states speeds
    bool moves_probe = false;  ///< a device, and not the mouse, moves the probe
    bool is_realtime = false;  ///< of the servo that runs
    bool is_let_go = false, is_grabbing = false;
    TapState tap;
    std::optional<double> recorded_s;  ///< of the recording under way
    std::filesystem::path recording;   ///< its file, or that of the last one; empty: none
};

/// "Touch (serial 1234)".
std::string name_in_words(const std::string& name, const std::string& serial);
/// What a person is told of a row: "moves the probe", "can push the hand", why it cannot.
std::string state_in_words(const DeviceListing& device, const HandView& hand);

struct Finding {
    Weight weight = Weight::done;
    std::string text;
    bool operator==(const Finding&) const = default;
};
/// What the servo does and why, one sentence each, the gravest first. Says nothing of force where none is wanted.
std::vector<Finding> findings_of(const HandView& hand, const ServoState& servo, bool is_guided);

/// "1000 times a second, half of them within 12 us".
std::string rhythm_in_words(const ServoState& servo);
/// Whether the system gives the servo the right of way, and what to do where it does not.
Finding realtime_in_words(bool is_realtime, uint64_t allowed_priority);
/// What this system allows: RLIMIT_RTPRIO.
uint64_t allowed_realtime_priority();
/// "cool", "warm", "hot" with the share of what the motors may hold for ever; empty for a device without motors.
std::string heat_in_words(double heat, const DeviceCaps& caps);

/// The bars of a plot, oldest first.
std::vector<float> plot_of(const TapState& tap);

}  // namespace shvr::ui
