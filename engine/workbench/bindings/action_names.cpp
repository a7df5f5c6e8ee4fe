#include "engine/workbench/bindings/action_names.h"

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/session/words/number_words.h"
#include "engine/session/words/setting_labels.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/appearance/layout.h"
#include "engine/workbench/models/preference_rows.h"

namespace shvr::ui {

namespace {

const JsonLimits LIMITS{.depth = 16, .expected = "an object"};

/// A value in an object: "light.ambient", and the value as JSON.
struct Leaf {
    std::string key, json;
};

void add_leaves(const JsonNode& node, const std::string& key, std::vector<Leaf>& leaves)
{
    if (!node.is_object()) return leaves.push_back({key, node.dump()});
    for (const std::string& name : node.names()) add_leaves(node[name], key.empty() ? name : key + '.' + name, leaves);
}

/// Returns what a patch sets; what it restores to the default only if it sets nothing.
std::vector<Leaf> leaves_of(const std::string& patch)
{
    const JsonDocument document(patch.empty() ? "{}" : patch, "change", LIMITS);
    std::vector<Leaf> leaves;
    add_leaves(document.root(), "", leaves);
    const auto is_restored = [](const Leaf& leaf) { return leaf.json == "null"; };
    if (!std::ranges::all_of(leaves, is_restored)) std::erase_if(leaves, is_restored);
    return leaves;
}

/// Returns a text of JSON without its quotes.
std::string text_in(const std::string& json)
{
    const JsonDocument document(json, "value", LIMITS);
    return document.root().is_text() ? document.root().any_text() : json;
}

std::string with_spaces(std::string key)
{
    std::ranges::replace(key, '_', ' ');
    return key;
}

std::string name_of_settings(const std::string& patch)
{
    const std::vector<Leaf> leaves = leaves_of(patch);
    if (leaves.empty()) return "Change settings";
    const std::string first = setting_in_words(leaves.front().key, leaves.front().json);
    return leaves.size() == 1 ? first : first + " and " + counted(int64_t(leaves.size()) - 1, "more setting");
}

std::string name_of_preference(const Leaf& leaf)
{
    constexpr std::string_view PANELS = "layout.panels.";
    if (leaf.key.starts_with(PANELS)) {
        const std::string id = leaf.key.substr(PANELS.size(), leaf.key.find('.', PANELS.size()) - PANELS.size());
        if (const PanelRow* const panel = panel_named(id)) return panel->title;
    }
    const bool is_restored = leaf.json == "null";
    const std::string value = is_restored ? "as by default" : value_in_words(leaf.key, leaf.json);
    if (leaf.key == "puck") return "SpaceMouse moves: the " + value;
    for (const PreferenceNumber& number : PREFERENCE_NUMBERS)
        if (leaf.key == number.key)
            return sentence(number.label, ": ", value) + (is_restored ? "" : sentence(' ', number.unit));
    return capitalised(with_spaces(leaf.key)) + ": " + value;
}

std::string name_of_preferences(const std::string& patch)
{
    const std::vector<Leaf> leaves = leaves_of(patch);
    return leaves.empty() ? "Preferences" : name_of_preference(leaves.front());
}

/// Returns an argument in words; empty: it has too many for a name, or says what the name says.
std::string argument_in_words(const std::string& key, const JsonNode& value)
{
    if (value.is_text()) return value.any_text();
    const std::string json = value.dump();
    const std::string name = key == "on" ? "" : with_spaces(key);
    if (value.is_number()) return name + ' ' + value_in_words(key, json);
    if (json == "true") return name;
    return json == "false" ? name + (name.empty() ? "off" : " off") : "";
}

std::string name_of_other(const Action& action)
{
    const JsonDocument line(line_of(action), "action", LIMITS);
    std::string words;
    for (const std::string& key : line.root().names()) {
        const std::string argument = key == "op" ? "" : argument_in_words(key, line.root()[key]);
        if (!argument.empty()) words += (words.empty() ? ": " : ", ") + argument;
    }
    return row_of(action).name + words;
}

}  // namespace

std::string title_of_setting(std::string_view key)
{
    const SettingLabel* const label = label_of_setting(key);
    return label ? capitalised(label->label) : std::string(key);
}

std::string setting_in_words(const std::string& key, const std::string& json)
{
    if (json == "null") return title_of_setting(key) + ": as by default";
    if (key == "transfer_function.preset") return "Transfer function " + text_in(json);
    if (key == "probe.group") return json == "0" ? "Eraser" : "Group " + json;
    if (key == "probe.brush")
        for (const BrushRow& row : BRUSHES)
            if (text_in(json) == row.key) return row.title;
    return title_of_setting(key) + ": " + value_in_words(key, json);
}

std::string name_of(const Action& action)
{
    if (const auto* const set = action.as<Set>()) return name_of_settings(set->patch);
    if (const auto* const prefer = action.as<Prefer>()) return name_of_preferences(prefer->patch);
    if (const auto* const look = action.as<LookFrom>()) return "Look from " + look->camera;
    if (const auto* const taken = action.as<TakeLook>()) return "Look " + taken->name;
    if (const auto* const open = action.as<Open>()) return "Open " + open->path.filename().string();
    if (const auto* const selected = action.as<SelectOp>(); selected && selected->number && !selected->is_internode)
        return sentence("Node ", *selected->number);
    if (const auto* const keys = action.as<ChooseKeys>())
        for (const Spelling<KeySet>& each : KEY_SETS)
            if (each.name == keys->set) return sentence("Keys: ", key_set_in_words(each.value));
    if (const auto* const shown = action.as<ShowDialog>())
        for (const OperationRow& row : OPERATION_ROWS)
            if (shown->operation == row.id) return row.title;
    return name_of_other(action);
}

}  // namespace shvr::ui
