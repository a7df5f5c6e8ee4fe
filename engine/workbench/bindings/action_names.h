#pragma once
// Actions with their arguments, as a person calls them: "Ambient light: 0.4", "Look from top". The palette, the list of
// keys and messages about keys use these names. Pure; any thread.

#include <string>
#include <string_view>

#include "engine/workbench/actions/action.h"

namespace shvr::ui {

/// Returns the action's name, with the arguments that fit into a few words.
std::string name_of(const Action& action);

/// Returns a setting as it is called in the window: "Ambient light". `key`: as in the table of keys.
std::string title_of_setting(std::string_view key);
/// Returns a setting with a value, given as JSON: "Ambient light: 0.4".
std::string setting_in_words(const std::string& key, const std::string& json);

}  // namespace shvr::ui
