#pragma once
// Reads and writes preferences: one JSON file, $XDG_CONFIG_HOME/shvr/preferences.json, written whole or not at all. Any
// thread.

#include <filesystem>
#include <string>
#include <string_view>

#include "engine/workbench/models/preferences.h"

namespace shvr::ui {

/// Where they are kept; empty where the environment names no home.
std::filesystem::path preferences_file();
/// Those of a file that does not exist are the defaults. Fails at unknown keys, shortcuts and chords, naming file, key,
/// value and what was expected.
Preferences load_preferences(const std::filesystem::path& file);
/// With a merge patch of that file applied, as in {"theme": "light"}; null takes what ships. Fails as reading does.
Preferences patched(const Preferences& preferences, std::string_view patch);
/// The patch that makes a change of a panel's place; `change` may set any of its parts.
std::string patch_of_panel(const std::string& id, const PanelLayout& change);
/// The patch that says where a window is (layout.h), in font sizes.
std::string patch_of_window(const std::string& id, const glm::dvec2& at, const glm::dvec2& size);
/// Makes the folder where it is missing.
void save_preferences(const std::filesystem::path& file, const Preferences& preferences);

}  // namespace shvr::ui
