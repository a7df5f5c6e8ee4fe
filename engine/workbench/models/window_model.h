#pragma once
// Read-only view of the preferences and of the window's own state.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/session/looks/named_look.h"
#include "engine/session/transfer_presets.h"
#include "engine/workbench/models/dialogs.h"

namespace shvr::ui {

class Keymap;
class RecentActions;
struct PassRun;
struct Preferences;

/// Made by the keeper of preferences.
struct PreferenceModel {
    const Keymap& keymap;
    const Preferences& preferences;
    std::string_view awaits_key{};    ///< id of the shortcut, or the action as text, that gets the next pressed key
    std::string_view key_question{};  ///< asks whether that takes over a key that stands for something else
};

/// Made by the shelf of presets.
struct PresetModel {
    const std::vector<TransferPreset>& presets;
};

/// Made by the shelf of looks.
struct LookModel {
    std::span<const NamedLook> looks{};  ///< those that the user saved, by name
};

/// Made by the state of the window.
struct WindowModel {
    bool shows_help = false, shows_messages = false, shows_passes = false, shows_palette = false,
         is_full_screen = false;
    bool asks_what_to_open = false, shows_preferences = false;
    Dialog dialog = Dialog::none;  ///< the dialog that is asked for
    std::string_view operation{};  ///< id of the operation that the window of operations on groups shows
    std::string_view gpu_name{};
    uint64_t device_bytes = 0, device_budget = 0;
    std::map<std::string, uint64_t> bytes_by_name{};  ///< device memory by name; empty unless the passes are shown
    const PassRun* compared_passes = nullptr;         ///< null: compared with nothing
};

/// Made by the workbench itself, for reports.
struct ReportModel {
    const RecentActions* recent = nullptr;  ///< the last actions; null: actions are not recorded
    std::string_view version{};             ///< the program's version
    double ui_frame_ms = 0.0;               ///< median over the last frames; the window sets it
};

}  // namespace shvr::ui
