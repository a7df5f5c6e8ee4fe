// Menus of the view: stored views, the pivot of rotation, drawings over pictures; and the size of new nodes.

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Draws the submenu of a stored view: go there, rename it, remove it.
void kept_view(const std::string& name, const Model& model, Actions& actions)
{
    static std::string edited;
    if (ImGui::IsWindowAppearing()) edited = name;
    if (ImGui::MenuItem("Go there")) actions.push_back(LookFrom{name});
    if (model.session.key_looks.contains(name) && ImGui::MenuItem("Go there with its look"))
        actions.push_back(LookFrom{name, true});
    ImGui::SetNextItemWidth(10.0f * ImGui::GetFontSize());
    const bool is_entered = ImGui::InputText("##name", &edited, ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::SameLine();
    const RenameCamera renaming{name, edited};
    const bool is_possible = !edited.empty() && why_not(model, renaming).empty();
    ImGui::BeginDisabled(!is_possible);
    if (ImGui::Button("Rename") || (is_entered && is_possible)) {
        actions.push_back(renaming);
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndDisabled();
    if (!begin_menu("Remove")) return;  // which cannot be undone
    if (ImGui::MenuItem("Remove this view")) actions.push_back(ForgetCamera{name});
    ImGui::EndMenu();
}

}  // namespace

void kept_views_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Kept views", model.is_open)) return;
    shortcut_item("keep_view", model, actions);
    shortcut_item("keep_view_for_movie", model, actions);
    ImGui::Separator();
    for (const auto& [name, camera] : model.session.cameras) {
        if (name == "window" || !begin_menu(verbatim(name).c_str())) continue;
        kept_view(name, model, actions);
        ImGui::EndMenu();
    }
    ImGui::EndMenu();
}

void sight_items(const Model& model, Actions& actions)
{
    const InteractionSettings& interaction = model.session.interaction;
    shortcut_item("pivot_at_pointer", model, actions, interaction.pivot == Pivot::picked);
    shortcut_item("pivot_at_probe", model, actions, interaction.pivot == Pivot::probe);
    ImGui::Separator();
    shortcut_item("scale_bar", model, actions, interaction.scale_bar);
    shortcut_item("axes", model, actions, interaction.axes);
    shortcut_item("group_legend", model, actions, interaction.group_legend);
    shortcut_item("probe_label", model, actions, interaction.probe_label);
    shortcut_item("auto_contrast", model, actions);
}

void new_nodes(const Model& model, Actions& actions)
{
    label("New nodes");
    double radius = model.session.probe.node_radius_voxels.value_or(model.brush().radius_voxels);
    constexpr double LEAST = 0.1, MOST = 127.0;
    ImGui::SetNextItemWidth(8.0f * ImGui::GetFontSize());
    if (drag_number("##new nodes", radius, 0.05, LEAST, MOST, "%.2f voxels", ImGuiSliderFlags_Logarithmic))
        set(actions, model, [&](Session& s) { s.probe.node_radius_voxels = radius; });
    hint("Radius of new nodes, independent of the brush.");
    ImGui::SameLine();
    bool is_measured = model.session.probe.measured_radius;
    if (ImGui::Checkbox("measured", &is_measured))
        set(actions, model, [&](Session& s) { s.probe.measured_radius = is_measured; });
    hint(
        "Radius of the largest ball above the paint threshold that contains the node. If there is none, the radius "
        "next to it is used.");
    bool is_centered = model.session.probe.centered_nodes;
    label("");
    if (ImGui::Checkbox("centred when clicked", &is_centered))
        set(actions, model, [&](Session& s) { s.probe.centered_nodes = is_centered; });
    hint(
        "A node clicked on a wall moves to the middle of the structure behind it, above the paint threshold. Otherwise "
        "it stays on the wall. In slices it stays where you click.");
}

}  // namespace shvr::ui
