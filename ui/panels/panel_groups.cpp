#include "ui/panels/panels.h"

#include <algorithm>
#include <set>
#include <vector>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/image.h"
#include "ui/panels/widgets.h"
#include "ui/workbench/edit.h"

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

struct Row {
    uint8_t group = 0;
    int depth = 0;  ///< below the groups without a parent
};

/// Groups that have a key, are described by the session, are painted or are chosen; each below its parent.
std::vector<Row> listed_groups(const Model& model)
{
    std::set<uint8_t> groups{model.brush().group};
    for (uint8_t group = 0; group <= GROUPS_WITH_KEYS; ++group) groups.insert(group);
    for (const auto& [group, settings] : model.session.groups) groups.insert({group, settings.parent});
    for (size_t group = 1; group < model.voxels_by_group.size(); ++group)
        if (model.voxels_by_group[group] > 0) groups.insert(uint8_t(group));
    std::vector<Row> rows;
    const auto add = [&](const auto& self, uint8_t group, int depth) -> void {
        rows.push_back({group, depth});
        for (const uint8_t child : groups)
            if (group != 0 && parent_of(model.session.groups, child) == group) self(self, child, depth + 1);
    };
    for (const uint8_t group : groups)
        if (parent_of(model.session.groups, group) == 0) add(add, group, 0);
    return rows;
}

// ---- The cells of a row. Each returns whether it changed a setting, and writes the result to `look`.

bool color_cell(const ColorGroup& look, GroupSettings& settings)
{
    ImGui::TableNextColumn();
    float shown[3];
    for (int i = 0; i < 3; ++i) shown[i] = float(srgb_encode(std::clamp(look.color[i], 0.0, 1.0)));
    if (!ImGui::ColorEdit3("##color", shown, ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel)) return false;
    glm::dvec3 color;
    for (int i = 0; i < 3; ++i) color[i] = std::clamp(srgb_decode(double(shown[i])), 0.0, 1.0);
    settings.color = color;
    return true;
}

bool visible_cell(const ColorGroup& look, GroupSettings& settings)
{
    ImGui::TableNextColumn();
    const bool changed = ImGui::Checkbox("##visible", &settings.visible);
    hint(settings.visible && !look.visible ? "Hidden together with its parent group."
                                           : "Shows or hides the voxels of this group and of its subgroups.");
    return changed;
}

/// A locked group neither gains nor loses voxels.
bool locked_cell(bool is_locked, GroupSettings& settings)
{
    ImGui::TableNextColumn();
    const bool changed = ImGui::Checkbox("##locked", &settings.locked);
    hint(is_locked && !settings.locked
             ? "Locked together with its parent group."
             : "Locked: no brush takes voxels from this group or its subgroups, or adds any.");
    return changed;
}

/// Chooses another parent, which must not be below this group.
bool parent_menu(uint8_t group, const Model& model, GroupSettings& settings)
{
    int parent = settings.parent;
    ImGui::SetNextItemWidth(7.0f * ImGui::GetFontSize());
    if (!ImGui::InputInt("Parent group (0: none)", &parent, 1, 10)) return false;
    parent = std::clamp(parent, 0, 255);
    if (parent != 0 && is_within(model.session.groups, uint8_t(parent), group)) return false;
    settings.parent = uint8_t(parent);
    return true;
}

/// A click on the name chooses the group; a right click opens its name and its parent for editing.
bool name_cell(const Row& row, const Model& model, const ColorGroup& look, GroupSettings& settings, Actions& actions)
{
    const uint8_t group = row.group;
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const float indent = float(row.depth) * ImGui::GetFontSize();
    if (indent > 0.0f) ImGui::Indent(indent);
    const std::string label = group == 0 ? "0  eraser" : std::to_string(group) + "  " + look.name;
    ImGui::PushStyleColor(ImGuiCol_Header, ImGui::GetColorU32(ImGuiCol_SliderGrab, CHOSEN_ALPHA));
    if (ImGui::Selectable(label.c_str(), group == model.brush().group))
        set(actions, model, [&](Session& s) { s.probe.brush.group = group; });
    ImGui::PopStyleColor();
    if (indent > 0.0f) ImGui::Unindent(indent);
    if (group == 0) {
        hint("Removes paint. Key: 0.");
        return false;
    }
    hint("Click: paint with this group. Right click: rename it, or choose its parent.");
    bool changed = false;
    if (ImGui::BeginPopupContextItem("settings")) {
        ImGui::SetNextItemWidth(12.0f * ImGui::GetFontSize());
        if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
        changed = ImGui::InputText("Name", &settings.name);
        if (ImGui::IsItemDeactivatedAfterEdit()) ImGui::CloseCurrentPopup();
        changed |= parent_menu(group, model, settings);
        if (ImGui::MenuItem("Usual colour", nullptr, false, settings.color.has_value())) {
            settings.color.reset();
            changed = true;
        }
        if (ImGui::MenuItem("Usual opacity", nullptr, false, settings.opacity.has_value())) {
            settings.opacity.reset();
            changed = true;
        }
        hint("Its parent's, where it has one.");
        ImGui::EndPopup();
    }
    return changed;
}

bool opacity_cell(const ColorGroup& look, GroupSettings& settings)
{
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(3.2f * ImGui::GetFontSize());
    const double least = 0.0, most = 1.0;
    double opacity = look.opacity;
    const bool changed = ImGui::DragScalar("##opacity", ImGuiDataType_Double, &opacity, 0.005f, &least, &most, "%.2f",
                                           ImGuiSliderFlags_AlwaysClamp);
    if (changed) settings.opacity = opacity;
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

void show_row(const Row& row, const Model& model, Actions& actions)
{
    ImGui::PushID(int{row.group});
    ImGui::TableNextRow();
    const ColorGroup look = group_of(model.session.groups, row.group);
    const auto found = model.session.groups.find(row.group);
    GroupSettings settings = found == model.session.groups.end() ? GroupSettings{} : found->second;
    if (row.group == 0) {
        for (int empty = 0; empty < 3; ++empty) ImGui::TableNextColumn();
        name_cell(row, model, look, settings, actions);
    } else {
        bool changed = color_cell(look, settings);
        changed |= visible_cell(look, settings);
        changed |= locked_cell(is_locked(model.session.groups, row.group), settings);
        changed |= name_cell(row, model, look, settings, actions);
        changed |= opacity_cell(look, settings);
        count_cell(model.voxels_by_group[row.group]);
        if (changed) set(actions, model, [&](Session& s) { s.groups[row.group] = settings; });
    }
    ImGui::PopID();
}

/// Chooses a group that has neither a key nor a row.
void other_group(const Model& model, Actions& actions)
{
    int group = model.brush().group;
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Paint with group");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(7.0f * ImGui::GetFontSize());
    if (ImGui::InputInt("##group", &group, 1, 10))
        set(actions, model, [&](Session& s) { s.probe.brush.group = uint8_t(std::clamp(group, 0, 255)); });
    hint("There are 255 groups; 0 erases. Groups in use are listed.");
}

}  // namespace

void groups_panel(const Model& model, Actions& actions)
{
    if (ImGui::BeginTable("groups", 6, ImGuiTableFlags_SizingFixedFit)) {
        ImGui::TableSetupColumn("##color");
        ImGui::TableSetupColumn("See");
        ImGui::TableSetupColumn("Lock");
        ImGui::TableSetupColumn("Group", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("Opacity");
        ImGui::TableSetupColumn("Voxels");
        ImGui::TableHeadersRow();
        for (const Row& row : listed_groups(model)) show_row(row, model, actions);
        ImGui::EndTable();
    }
    other_group(model, actions);
}

}  // namespace shvr::ui
