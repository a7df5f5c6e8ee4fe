#pragma once
// Actions on looks that the user keeps for all scans (engine/session/looks).

#include "engine/session/transfer_presets.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class LookShelf;

/// Saves groups, light and transfer function of the open scan as a look.
struct KeepLook {
    std::string name;            ///< for all scans; or
    std::filesystem::path path;  ///< a file for other machines, which must not exist
};

/// Gives the open scan a look, as a step that can be undone.
struct TakeLook {
    std::string name;
};

struct ForgetLook {
    std::string name;
};

/// Returns why there is no look of this name; empty: there is one.
inline std::string why_no_look(const auto& model, const std::string& name)
{
    for (const auto& look : model.looks)
        if (look.name == name) return {};
    return "no look is kept as " + name;
}

inline constexpr const char* LOOK_GROUP = "Looks";

inline constexpr auto LOOK_ACTIONS = std::tuple{
    row<KeepLook, LookShelf>(
        {"keep_look", "Save the look", LOOK_GROUP,
         "saves groups, light and transfer function under a name for all scans, or to a file"},
        [](auto& f, KeepLook& a) {
            f.text("name", a.name, {"name of the look, for all scans"});
            f.path("path", a.path, {"a new file, instead of a name"});
        },
        [](const auto& model, const KeepLook& action) -> std::string {
            if (model.session.transfer_function.points().size() < 2) return "there is no transfer function";
            if (action.name.empty() == action.path.empty()) return "expected either a name or a file";
            return action.path.empty() ? why_no_name(action.name, "look") : "";
        }),
    row<TakeLook, LookShelf>(
        {"take_look", "Apply a look", LOOK_GROUP, "gives the scan groups, light and transfer function of a saved look"},
        [](auto& f, TakeLook& a) { f.text("name", a.name, {.is_required = true}); },
        [](const auto& model, const TakeLook& action) -> std::string { return why_no_look(model, action.name); }),
    row<ForgetLook, LookShelf>(
        {"forget_look", "Remove a look", LOOK_GROUP, "removes a saved look; scans that have it keep it"},
        [](auto& f, ForgetLook& a) { f.text("name", a.name, {.is_required = true}); },
        [](const auto& model, const ForgetLook& action) -> std::string { return why_no_look(model, action.name); })};

}  // namespace shvr::ui
