#pragma once
// Reads and writes preferences: one JSON file, preferences.json in the folder of settings (config_folder() in
// engine/base/assets.h), replaced atomically. Any thread.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/workbench/models/preferences.h"

namespace shvr::ui {

/// Returns the path of the file in the folder of settings; empty if there is no such folder.
std::filesystem::path preferences_file(const std::filesystem::path& settings);
/// Returns defaults if the file does not exist. Fails at unknown keys and values, naming file, key, value and the
/// expected value. An unknown shortcut or chord is not an error: that change of keys goes to `unusable_keys`, and a
/// sentence that describes it to `complaints`.
Preferences load_preferences(const std::filesystem::path& file, std::vector<std::string>* complaints = nullptr);
/// Applies a merge patch, as in {"theme": "light"}; null restores a default. Fails like load_preferences.
Preferences patched(const Preferences& preferences, std::string_view patch);
/// Returns the patch that changes a panel's layout; `change` may set any of its parts.
std::string patch_of_panel(const std::string& id, const PanelLayout& change);
/// Returns the patch that sets a window's position and size (layout.h), in font sizes.
std::string patch_of_window(const std::string& id, const glm::dvec2& at, const glm::dvec2& size);
/// Writes the file; creates its folder if missing.
void save_preferences(const std::filesystem::path& file, const Preferences& preferences);

}  // namespace shvr::ui
