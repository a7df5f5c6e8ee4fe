// Colour groups as a tree: appearance, locks, contents and parents.

#include "ui/panels/panels.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/lists/group_list.h"
#include "ui/panels/color_field.h"
#include "ui/panels/field_keys.h"
#include "ui/panels/imgui_keys.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr float CHOSEN_ALPHA = 0.45f;  ///< opacity of the accent colour
constexpr const char* DRAGGED = "group";
constexpr float MAX_GROUP_LINES = 16.0f;

/// Between frames.
struct GroupsState {
    std::string search;
    bool shows_sizes = false;
    uint64_t revision = ~uint64_t{0};  ///< revision of the trace that `traced` describes
    std::array<TracedGroup, 256> traced{};
    std::vector<uint8_t> in_trace;
};
GroupsState groups_state;

void follow_trace(const Model& model)
{
    if (groups_state.revision == model.trace.revision()) return;
    groups_state.revision = model.trace.revision();
    groups_state.traced = traced_groups(model.trace);
    groups_state.in_trace = groups_in(groups_state.traced);
}

// ---- The cells of a row. Each returns whether the user changed a setting, and stores the change in `settings`

bool color_cell(const ColorGroup& look, GroupSettings& settings)
{
    ImGui::TableNextColumn();
    glm::dvec3 color = look.color;
    if (!color_field("##color", color)) return false;
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

/// Draws the lock of a group. A locked group neither gains nor loses voxels.
bool locked_cell(bool is_locked, GroupSettings& settings)
{
    ImGui::TableNextColumn();
    const bool changed = ImGui::Checkbox("##locked", &settings.locked);
    hint(is_locked && !settings.locked
             ? "Locked together with its parent group."
             : "Locked: no brush takes voxels from this group or its subgroups, or adds any.");
    return changed;
}

/// Draws the switch for showing only this group. The other groups keep their own visibility settings.
void solo_cell(uint8_t group, const Model& model, Actions& actions)
{
    ImGui::TableNextColumn();
    const bool is_alone = model.session.view.solo == group;
    if (is_alone) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetColorU32(ImGuiCol_SliderGrab));
    if (ImGui::SmallButton("S"))
        set(actions, model, [&](Session& s) { s.view.solo = is_alone ? std::nullopt : std::optional(group); });
    if (is_alone) ImGui::PopStyleColor();
    hint(is_alone     ? "Shows the others again, as they were."
         : group == 0 ? "Shows only unpainted voxels, until clicked again."
                      : "Shows only this group and its subgroups, until clicked again.");
}

// ---- The tree

void set_parent(uint8_t group, uint8_t parent, const Model& model, Actions& actions)
{
    set(actions, model, [&](Session& s) { s.groups[group].parent = parent; });
}

/// Drag and drop: on another group's row, a dropped group becomes its child; on the unpainted row, it loses its parent.
void drag_and_drop(uint8_t group, const Model& model, Actions& actions)
{
    if (group != 0 && ImGui::BeginDragDropSource()) {
        ImGui::SetDragDropPayload(DRAGGED, &group, sizeof group);
        ImGui::TextUnformatted(label_of_group(model.session.groups, group).c_str());
        ImGui::TextDisabled("Drop it onto its parent group,\nor onto 0 for no parent.");
        ImGui::EndDragDropSource();
    }
    if (!ImGui::BeginDragDropTarget()) return;
    if (const ImGuiPayload* const payload = ImGui::AcceptDragDropPayload(DRAGGED)) {
        const uint8_t dragged = *static_cast<const uint8_t*>(payload->Data);
        if (why_not_below(model.session.groups, dragged, group).empty()) set_parent(dragged, group, model, actions);
    }
    ImGui::EndDragDropTarget();
}

/// Draws the name of a group in a popup, which Enter closes. Returns the new name once it is typed.
std::optional<std::string> group_name_field(uint8_t group, const Model& model, FieldKeys& keys)
{
    const std::string name = group_of(model.session.groups, group).name;
    ImGui::SetNextItemWidth(14.0f * ImGui::GetFontSize());
    keys.before_field(ImGui::IsWindowAppearing());
    std::optional<std::string> renamed = name_field("##name", name);
    keys.after_field();
    const bool is_entered = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false) ||
                            ImGui::IsKeyPressed(ImGui::GetKeyIndex(KEYPAD_ENTER), false);
    if (ImGui::IsItemDeactivated() && is_entered) ImGui::CloseCurrentPopup();
    return renamed;
}

bool settings_popup(uint8_t group, const Model& model, GroupSettings& settings, Actions& actions)
{
    if (!ImGui::BeginPopupContextItem("settings")) return false;
    static FieldKeys keys;
    const std::optional<std::string> renamed = group_name_field(group, model, keys);
    ImGui::SameLine();
    ImGui::TextUnformatted("Name");
    bool changed = renamed.has_value();
    if (renamed) settings.name = *renamed;
    if (ImGui::MenuItem("Belongs to no group", nullptr, false, settings.parent != 0))
        set_parent(group, 0, model, actions);
    if (ImGui::MenuItem("Default name", nullptr, false, !settings.name.empty())) {
        settings.name.clear();
        changed = true;
    }
    if (ImGui::MenuItem("Default colour", nullptr, false, settings.color.has_value())) {
        settings.color.reset();
        changed = true;
    }
    if (ImGui::MenuItem("Default opacity", nullptr, false, settings.opacity.has_value())) {
        settings.opacity.reset();
        changed = true;
    }
    hint("Uses the parent group's opacity, if there is a parent.");
    end_popup();
    return changed;
}

/// Draws the name of a group. A click on the name activates the group.
bool name_cell(const GroupRow& row, const Model& model, GroupSettings& settings, Actions& actions)
{
    const uint8_t group = row.group;
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const float indent = float(row.depth) * ImGui::GetFontSize();
    if (indent > 0.0f) ImGui::Indent(indent);
    if (!row.is_found) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::PushStyleColor(ImGuiCol_Header, ImGui::GetColorU32(ImGuiCol_SliderGrab, CHOSEN_ALPHA));
    const std::string label = group == 0 ? "0  unpainted" : label_of_group(model.session.groups, group);
    const std::string shown = shortened(verbatim(label), ImGui::GetContentRegionAvail().x) + "###name";
    if (ImGui::Selectable(shown.c_str(), group == model.brush().group, ImGuiSelectableFlags_AllowDoubleClick))
        set(actions, model, [&](Session& s) { s.probe.brush.group = group; });
    if (group != 0 && is_double_clicked()) ImGui::OpenPopup("settings");
    ImGui::PopStyleColor(row.is_found ? 1 : 2);
    if (indent > 0.0f) ImGui::Unindent(indent);
    drag_and_drop(group, model, actions);
    if (group == 0) {
        hint(("The volume where nothing is painted. Click: the eraser" + key_in_brackets("eraser", model.keymap) + ".")
                 .c_str());
        return false;
    }
    hint((label +
          "\nClick: paint with this group. Double click: rename it. Drag: put it below another. Right click: more.")
             .c_str());
    return settings_popup(group, model, settings, actions);
}

bool opacity_drag(double& opacity)
{
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(3.0f * ImGui::GetFontSize());
    return drag_number("##opacity", opacity, 0.005, 0.0, 1.0, "%.2f");
}

void right_aligned(const std::string& text, bool is_grey)
{
    const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
    if (room > 0.0f) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
    ImGui::AlignTextToFramePadding();
    if (is_grey)
        ImGui::TextDisabled("%s", text.c_str());
    else
        ImGui::TextUnformatted(text.c_str());
}

void count_cell(int64_t count)
{
    ImGui::TableNextColumn();
    right_aligned(std::to_string(count), count == 0);
    hint("Voxels of this group.");
}

/// Draws the radius of a group's nodes or internodes, in voxels. The history gets one step, when the mouse is released.
void size_cell(const char* id, uint8_t group, size_t count, double radius_units, RadiusOp::Of of, const Model& model,
               Actions& actions)
{
    static ImGuiID edited_id = 0;
    static double edited = 0.0;
    ImGui::TableNextColumn();
    if (count == 0) return right_aligned("-", true);
    const ImGuiID own = ImGui::GetID(id);
    const double before = radius_units / model.volume.spacing.x;
    double radius = edited_id == own ? edited : before;
    constexpr double LEAST = 0.0, MOST = 1000.0;
    ImGui::SetNextItemWidth(-1.0f);
    drag_number(id, radius, 0.05, LEAST, MOST, "%.2f");
    if (ImGui::IsItemActive()) {
        edited_id = own;
        edited = radius;
    } else if (edited_id == own) {
        edited_id = 0;
    }
    if (ImGui::IsItemDeactivatedAfterEdit() && radius != before)
        actions.push_back(RadiusOp{.of = of, .radius_voxels = radius, .group = group});
    hint(of == RadiusOp::Of::nodes ? "Mean radius of the group's nodes, in voxels; a change applies to all of them."
                                   : "Mean radius of the group's internodes, in voxels; a change applies to all of "
                                     "them, and they no longer taper.");
}

void size_cells(uint8_t group, const Model& model, Actions& actions)
{
    const TracedGroup& traced = groups_state.traced[group];
    size_cell("##nodes", group, traced.nodes, traced.node_radius, RadiusOp::Of::nodes, model, actions);
    size_cell("##internodes", group, traced.internodes, traced.internode_radius, RadiusOp::Of::internodes, model,
              actions);
}

// ---- Rows

/// Draws the row for the unpainted part of the volume.
void unpainted_row(const GroupRow& row, const Model& model, Actions& actions)
{
    Unpainted unpainted = model.session.unpainted;
    GroupSettings none;
    ImGui::TableNextColumn();
    ImGui::TableNextColumn();
    bool changed = ImGui::Checkbox("##visible", &unpainted.visible);
    hint("Shows or hides the volume where nothing is painted.");
    ImGui::TableNextColumn();
    solo_cell(0, model, actions);
    name_cell(row, model, none, actions);
    changed |= opacity_drag(unpainted.opacity);
    hint("Opacity of the volume where nothing is painted: the transfer function is multiplied by it. Drag sideways.");
    if (!resets("unpainted.opacity", actions) && changed)
        set(actions, model, [&](Session& s) { s.unpainted = unpainted; });
    ImGui::TableNextColumn();
}

void group_row(const GroupRow& row, const Model& model, Actions& actions)
{
    const ColorGroup look = group_of(model.session.groups, row.group);
    const auto found = model.session.groups.find(row.group);
    GroupSettings settings = found == model.session.groups.end() ? GroupSettings{} : found->second;
    bool changed = color_cell(look, settings);
    changed |= visible_cell(look, settings);
    changed |= locked_cell(is_locked(model.session.groups, row.group), settings);
    solo_cell(row.group, model, actions);
    changed |= name_cell(row, model, settings, actions);
    double opacity = look.opacity;
    if (opacity_drag(opacity)) {
        settings.opacity = opacity;
        changed = true;
    }
    hint("Opacity of one voxel of the group: 0 clear, 1 solid. Drag sideways; double-click for the default.");
    const bool is_reset = resets(sentence("groups.", int(row.group), ".opacity").c_str(), actions);
    count_cell(model.voxels_by_group[row.group]);
    if (changed && !is_reset) set(actions, model, [&](Session& s) { s.groups[row.group] = settings; });
}

/// Draws a group with the sizes of its nodes and internodes.
void size_row(const GroupRow& row, const Model& model, Actions& actions)
{
    GroupSettings settings;
    if (const auto found = model.session.groups.find(row.group); found != model.session.groups.end())
        settings = found->second;
    bool changed = color_cell(group_of(model.session.groups, row.group), settings);
    changed |= name_cell(row, model, settings, actions);
    size_cells(row.group, model, actions);
    if (changed) set(actions, model, [&](Session& s) { s.groups[row.group] = settings; });
}

void set_up_group_columns()
{
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn("##color");
    if (groups_state.shows_sizes) {
        ImGui::TableSetupColumn("Group", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("Nodes", ImGuiTableColumnFlags_WidthFixed, 5.0f * ImGui::GetFontSize());
        ImGui::TableSetupColumn("Internodes", ImGuiTableColumnFlags_WidthFixed, 5.0f * ImGui::GetFontSize());
    } else {
        for (const char* name : {"See", "Lock", "##solo"}) ImGui::TableSetupColumn(name);
        ImGui::TableSetupColumn("Group", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("Opacity");
        ImGui::TableSetupColumn("Voxels");
    }
    ImGui::TableHeadersRow();
}

void group_table(const Model& model, Actions& actions)
{
    const std::vector<GroupRow> rows = listed_groups(model.session.groups, model.voxels_by_group, groups_state.in_trace,
                                                     model.brush().group, groups_state.search);
    if (rows.empty()) return ImGui::TextDisabled("No group has this in its name.");
    const float line = ImGui::GetFrameHeight() + 2.0f * ImGui::GetStyle().CellPadding.y;
    const float height = line * std::min(float(rows.size()) + 1.0f, MAX_GROUP_LINES);
    const ImGuiTableFlags flags = ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_ScrollY;
    if (!ImGui::BeginTable("groups", groups_state.shows_sizes ? 4 : 7, flags, {0.0f, height})) return;
    set_up_group_columns();
    for (const GroupRow& row : rows) {
        if (row.group == 0 && groups_state.shows_sizes) continue;
        ImGui::PushID(int{row.group});
        ImGui::TableNextRow();
        if (groups_state.shows_sizes)
            size_row(row, model, actions);
        else if (row.group == 0)
            unpainted_row(row, model, actions);
        else
            group_row(row, model, actions);
        ImGui::PopID();
    }
    ImGui::EndTable();
}

/// Draws a button that renames the group, for use without a right mouse button or without a mouse.
void rename_button(const Model& model, Actions& actions)
{
    const uint8_t group = model.brush().group;
    ImGui::BeginDisabled(group == 0);
    if (ImGui::Button("Rename")) ImGui::OpenPopup("rename");
    ImGui::EndDisabled();
    hint("Renames the active group.");
    if (!ImGui::BeginPopup("rename")) return;
    static FieldKeys keys;
    if (const auto renamed = group_name_field(group, model, keys))
        set(actions, model, [&](Session& s) { s.groups[group].name = *renamed; });
    end_popup();
}

/// Draws the search field, the button for a new group, and the choice of the values shown next to the names.
void tools(const Model& model, Actions& actions)
{
    const uint8_t next = free_group(model.session.groups, model.voxels_by_group, groups_state.in_trace);
    ImGui::SetNextItemWidth(6.0f * ImGui::GetFontSize());
    ImGui::InputTextWithHint("##search", "Search", &groups_state.search);
    hint("Part of a name, or a number.");
    ImGui::SameLine();
    ImGui::BeginDisabled(next == 0);
    if (ImGui::Button("New group")) actions.emplace_back(NewGroup{});
    ImGui::EndDisabled();
    hint(next == 0 ? "All 255 groups are in use." : "Activates an unused group to paint and trace with.");
    ImGui::SameLine();
    rename_button(model, actions);
    ImGui::SameLine();
    ImGui::Checkbox("Sizes", &groups_state.shows_sizes);
    hint("Shows radii of nodes and internodes instead of numbers of voxels.");
    if (!model.session.view.solo) return;
    if (ImGui::SmallButton("Show all groups again")) set(actions, model, [](Session& s) { s.view.solo.reset(); });
}

}  // namespace

void groups_panel(const Model& model, Actions& actions)
{
    follow_trace(model);
    tools(model, actions);
    group_table(model, actions);
}

}  // namespace shvr::ui
