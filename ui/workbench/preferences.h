#pragma once
// What a person keeps for all scans: keys, and what was opened last. One JSON file, $XDG_CONFIG_HOME/shvr/
// preferences.json, written whole or not at all. Any thread.

#include <filesystem>
#include <vector>

#include "ui/workbench/bindings/keymap.h"

namespace shvr::ui {

struct Preferences {
    static constexpr size_t MAX_RECENT = 12;

    KeySet key_set = KeySet::modern;
    Keymap::Changes keys;                       ///< in place of those of the set
    std::vector<std::filesystem::path> recent;  ///< newest first, each once

    void note_opened(const std::filesystem::path& path);
    bool operator==(const Preferences&) const = default;
};

/// Where they are kept; empty where the environment names no home.
std::filesystem::path preferences_file();
/// Those of a file that does not exist are the defaults. Fails at unknown keys, shortcuts and chords, naming file, key,
/// value and what was expected.
Preferences load_preferences(const std::filesystem::path& file);
/// Makes the folder where it is missing.
void save_preferences(const std::filesystem::path& file, const Preferences& preferences);

}  // namespace shvr::ui
