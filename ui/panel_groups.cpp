#include "ui/panels.h"

#include <algorithm>
#include <set>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/image.h"
#include "ui/widgets.h"

namespace shvr::ui {

namespace {

constexpr uint8_t GROUPS_WITH_KEYS = 9;
constexpr float CHOSEN_ALPHA = 0.45f;  ///< of the accent colour

/// 1234567 as "1,234,567"
std::string with_separators(int64_t count)
{
    std::string text = std::to_string(count);
    for (size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
    return text;
}

/// Those with a key, those that the session describes, those that were painted, and the one that is chosen.
std::set<uint8_t> listed_groups(const Model& model)
{
    std::set<uint8_t> groups{model.brush.group};
    for (uint8_t group = 0; group <= GROUPS_WITH_KEYS; ++group) groups.insert(group);
    for (const auto& [group, look] : model.session.groups) groups.insert(group);
    for (size_t group = 1; group < model.voxels_by_group.size(); ++group)
        if (model.voxels_by_group[group] > 0) groups.insert(uint8_t(group));
    return groups;
}

// ---- The cells of a row. Each tells whether it changed the look.

bool color_cell(ColorGroup& look)
{
    ImGui::TableNextColumn();
    float shown[3];
    for (int i = 0; i < 3; ++i) shown[i] = float(srgb_encode(std::clamp(look.color[i], 0.0, 1.0)));
    const bool changed =
        ImGui::ColorEdit3("##color", shown, ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel);
    if (changed)
        for (int i = 0; i < 3; ++i) look.color[i] = std::clamp(srgb_decode(double(shown[i])), 0.0, 1.0);
    return changed;
}

bool visible_cell(ColorGroup& look)
{
    ImGui::TableNextColumn();
    const bool changed = ImGui::Checkbox("##visible", &look.visible);
    hint("Whether the group's voxels are drawn.");
    return changed;
}

/// The name chooses the group; a right click renames it.
bool name_cell(uint8_t group, const Model& model, ColorGroup& look, Actions& actions)
{
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const std::string label = group == 0 ? "0  eraser" : std::to_string(group) + "  " + look.name;
    ImGui::PushStyleColor(ImGuiCol_Header, ImGui::GetColorU32(ImGuiCol_SliderGrab, CHOSEN_ALPHA));
    if (ImGui::Selectable(label.c_str(), group == model.brush.group)) actions.push_back(ChooseGroup{group});
    ImGui::PopStyleColor();
    if (group == 0) {
        hint("Paints voxels back to unpainted. Key: 0.");
        return false;
    }
    hint("Click: paint with this group. Right click: rename it.");
    bool changed = false;
    if (ImGui::BeginPopupContextItem("rename")) {
        ImGui::SetNextItemWidth(12.0f * ImGui::GetFontSize());
        if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
        changed = ImGui::InputText("Name", &look.name);
        if (ImGui::IsItemDeactivatedAfterEdit()) ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }
    return changed;
}

bool opacity_cell(ColorGroup& look)
{
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(3.2f * ImGui::GetFontSize());
    const double least = 0.0, most = 1.0;
    const bool changed = ImGui::DragScalar("##opacity", ImGuiDataType_Double, &look.opacity, 0.005f, &least, &most,
                                           "%.2f", ImGuiSliderFlags_AlwaysClamp);
    hint("Opacity of one voxel of the group: 0 clear, 1 solid. Drag sideways.");
    return changed;
}

void count_cell(int64_t count)
{
    ImGui::TableNextColumn();
    const std::string text = with_separators(count);
    const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
    if (room > 0.0f) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
    ImGui::AlignTextToFramePadding();
    if (count == 0)
        ImGui::TextDisabled("0");
    else
        ImGui::TextUnformatted(text.c_str());
    hint("Voxels of this group.");
}

void row(uint8_t group, const Model& model, Actions& actions)
{
    ImGui::PushID(int{group});
    ImGui::TableNextRow();
    ColorGroup look = group_of(model.session, group);
    if (group == 0) {
        ImGui::TableNextColumn();
        ImGui::TableNextColumn();
        name_cell(group, model, look, actions);
    } else {
        bool changed = color_cell(look);
        changed |= visible_cell(look);
        changed |= name_cell(group, model, look, actions);
        changed |= opacity_cell(look);
        count_cell(model.voxels_by_group[group]);
        if (changed) actions.push_back(SetGroup{group, look});
    }
    ImGui::PopID();
}

/// Groups without a key and a row.
void other_group(const Model& model, Actions& actions)
{
    int group = model.brush.group;
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Paint with group");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(7.0f * ImGui::GetFontSize());
    if (ImGui::InputInt("##group", &group, 1, 10)) actions.push_back(ChooseGroup{uint8_t(std::clamp(group, 0, 255))});
    hint("There are 255 groups; 0 erases. Those that are used get a row.");
}

}  // namespace

void groups_panel(const Model& model, Actions& actions)
{
    if (ImGui::BeginTable("groups", 5, ImGuiTableFlags_SizingFixedFit)) {
        ImGui::TableSetupColumn("color");
        ImGui::TableSetupColumn("visible");
        ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("opacity");
        ImGui::TableSetupColumn("voxels");
        for (const uint8_t group : listed_groups(model)) row(group, model, actions);
        ImGui::EndTable();
    }
    other_group(model, actions);
}

}  // namespace shvr::ui
