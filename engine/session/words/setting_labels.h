#pragma once
// The settings of a session as a person calls them, by their keys. Pure; any thread.

#include <span>
#include <string>
#include <string_view>

namespace shvr {

struct SettingLabel {
    std::string_view key;     ///< as in the table of keys: "light.ambient", "groups.N.color"
    std::string_view label;   ///< a noun phrase: "ambient light"
    std::string_view unit{};  ///< after the value; empty: none
    /// The panels' words for it and for its values, where they are others; for searches.
    std::string_view in_panels{};
};

/// Returns the labels of all settings that sessions patch (session_patch.h), in the order of the table of keys.
std::span<const SettingLabel> setting_labels();
/// Returns null for a key without a label. `key`: as in the table, or with a number: "groups.3.color".
const SettingLabel* label_of_setting(std::string_view key);
/// Returns a setting's value in words, with its unit. `json`: the value as JSON; empty or null: none.
std::string value_in_words(std::string_view key, const std::string& json);

}  // namespace shvr
