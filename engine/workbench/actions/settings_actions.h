#pragma once
// Actions on settings, and on the transfer functions that the user saves for all scans (transfer_presets.h).

#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class PresetShelf;
class SettingsEditor;

/// Changes settings by a patch of the session (session_patch.h). Changes of lasting settings become a history step.
struct Set {
    std::string patch;
};

/// Adds a group with the lowest unused number to the session, and makes it the active group.
struct NewGroup {};

/// Records all changes of settings since the last step as one history step, as the end of a drag does.
struct EndStep {};

/// Sets the black and white levels of slices so that almost all voxel values lie between them.
struct AutoContrast {};

struct KeepPreset {
    std::string name;
};

struct RenamePreset {
    std::string name, to;
};

struct ForgetPreset {
    std::string name;
};

/// Applies the transfer function stored in a file, which need not be one of the saved presets.
struct TakePreset {
    std::filesystem::path path;
};

inline constexpr const char* SETTINGS_GROUP = "Settings";

inline constexpr auto SETTINGS_ACTIONS = std::tuple{
    row<Set, SettingsEditor>(
        {"set", "Change settings", SETTINGS_GROUP, "sets any keys of the session; null restores a key's default"},
        [](auto& f, Set& a) {
            const auto read = [&](const JsonNode& node) {
                if (!node.is_object()) node.refuse("an object such as {\"light\": {\"ambient\": 0.4}}");
                a.patch = node.dump();
            };
            f.other("values", read, [&] { return std::optional(a.patch); }, {.is_required = true});
        }),
    row<NewGroup, SettingsEditor>({"new_group", "New group", SETTINGS_GROUP, "activates the first unused group"}),
    row<EndStep, SettingsEditor>({"end_step", "End the step", SETTINGS_GROUP,
                                  "makes one history step of the settings changed since the last; also automatic"}),
    row<AutoContrast, SettingsEditor>({"auto_contrast", "Contrast of the slices", SETTINGS_GROUP,
                                       "sets black and white so that almost all lies between them"}),
    row<KeepPreset, PresetShelf>(
        {"keep_preset", "Keep the transfer function", SETTINGS_GROUP,
         "keeps the transfer function under a name, for all scans"},
        [](auto& f, KeepPreset& a) { f.text("name", a.name, {.is_required = true}); },
        [](const auto& model, const KeepPreset&) -> std::string {
            return model.session.transfer_function.points().size() < 2 ? "there is no transfer function" : "";
        }),
    row<RenamePreset, PresetShelf>(
        {"rename_preset", "Rename a transfer function", SETTINGS_GROUP, "renames a kept transfer function"},
        [](auto& f, RenamePreset& a) {
            f.text("name", a.name, {.is_required = true});
            f.text("to", a.to, {.is_required = true});
        },
        [](const auto& model, const RenamePreset& action) -> std::string { return why_not_own(model, action.name); }),
    row<ForgetPreset, PresetShelf>(
        {"forget_preset", "Forget a transfer function", SETTINGS_GROUP, "removes a kept transfer function"},
        [](auto& f, ForgetPreset& a) { f.text("name", a.name, {.is_required = true}); },
        [](const auto& model, const ForgetPreset& action) -> std::string { return why_not_own(model, action.name); }),
    row<TakePreset, SettingsEditor>(
        {"take_preset", "Take a transfer function", SETTINGS_GROUP, "takes the transfer function of a file"},
        [](auto& f, TakePreset& a) { f.path("path", a.path, {.is_required = true}); })};

}  // namespace shvr::ui
