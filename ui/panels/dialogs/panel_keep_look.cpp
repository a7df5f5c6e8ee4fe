// Looks: the menu that applies them, and the dialog that saves one for all scans or in a file.

#include <algorithm>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/text.h"
#include "engine/workbench/actions/action_rows.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/dialogs/file_chooser.h"
#include "ui/panels/field_keys.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char* KEEP_TITLE = "Save the look";

FileChooser to_file({.title = "Save the look in a file",
                     .verb = "Save",
                     .note = "Look (.json), for other machines: Load annotation applies it.",
                     .wanted = FileChooser::Wanted::new_file});

/// Draws the name. Returns whether Enter was pressed in it.
bool look_name_row(std::string& name)
{
    static FieldKeys keys;
    keys.before_field(ImGui::IsWindowAppearing());
    ImGui::SetNextItemWidth(20.0f * ImGui::GetFontSize());
    const bool is_entered =
        ImGui::InputTextWithHint("##name", "name of the look", &name, ImGuiInputTextFlags_EnterReturnsTrue);
    keys.after_field();
    return is_entered;
}

/// Says what saving under the name does, or why that cannot be.
void look_note(const KeepLook& keep, const Model& model, const std::string& why)
{
    if (keep.name.empty()) return dialog_note("Names and colours of groups, the light and the transfer function.", {});
    const bool replaces = std::ranges::find(model.looks, keep.name, &NamedLook::name) != model.looks.end();
    if (replaces) return dialog_note({}, why.empty() ? "The look that has this name is replaced." : why);
    dialog_note("It can then be applied to any scan: View, Looks.", why);
}

/// Draws the buttons. Returns whether the dialog ends.
bool ends_keeping(const KeepLook& keep, bool is_entered, const std::string& why, const Model& model, Actions& actions)
{
    ImGui::BeginDisabled(!why.empty());
    const bool is_confirmed = ImGui::Button("Save") || (is_entered && why.empty());
    ImGui::EndDisabled();
    if (is_confirmed) actions.push_back(keep);
    ImGui::SameLine();
    const bool asks_for_file = ImGui::Button("In a file...");
    if (asks_for_file)
        to_file.ask(std::filesystem::path(model.session_path).replace_extension().string() + "-look.json", {});
    ImGui::SameLine();
    const bool is_cancelled =
        ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
    return is_confirmed || asks_for_file || is_cancelled;
}

}  // namespace

void keep_look_dialog(const Model& model, Actions& actions)
{
    static bool was_shown = false;
    static std::string name;
    if (const auto path = to_file.draw()) actions.push_back(KeepLook{.name = {}, .path = *path});
    const bool is_wanted = model.dialog == Dialog::keep_look;
    if (is_wanted && !std::exchange(was_shown, true)) {
        name.clear();
        ImGui::OpenPopup(KEEP_TITLE);
    }
    if (!was_shown) return;
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    size_dialog();
    bool is_over = true;
    if (begin_dialog(KEEP_TITLE, ImGuiWindowFlags_AlwaysAutoResize)) {
        const bool is_entered = look_name_row(name);
        const KeepLook keep{.name = std::string(trimmed(name)), .path = {}};
        const std::string why = why_not(model, keep);
        look_note(keep, model, why);
        is_over = ends_keeping(keep, is_entered, why, model, actions) || !is_wanted;
        if (is_over) ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }
    if (!is_over) return;
    was_shown = false;
    if (is_wanted) actions.push_back(ShowDialog{});
}

void looks_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Looks", model.is_open)) return;
    if (model.looks.empty()) ImGui::TextDisabled("None is saved yet");
    for (const NamedLook& look : model.looks)
        if (ImGui::MenuItem((verbatim(look.name) + "##look").c_str())) actions.push_back(TakeLook{look.name});
    ImGui::Separator();
    shortcut_item("keep_look", model, actions);
    hint("Names and colours of groups, the light and the transfer function, for the next scan.");
    shortcut_item("load_annotation", model, actions);
    hint("A look in a file, as those that were saved in one. Or drop it on the window.");
    if (begin_menu("Remove", !model.looks.empty())) {
        for (const NamedLook& look : model.looks)
            if (ImGui::MenuItem(verbatim(look.name).c_str())) actions.push_back(ForgetLook{look.name});
        ImGui::EndMenu();
    }
    ImGui::EndMenu();
}

}  // namespace shvr::ui
