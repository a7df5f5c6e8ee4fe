// The trace as lists of segments and of nodes: lengths, groups and positions.

#include <algorithm>
#include <cstdio>
#include <string>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/lists/trace_list.h"
#include "ui/panels/color_field.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr float MAX_TRACE_LINES = 14.0f;
constexpr float SELECTED_ALPHA = 0.45f;  ///< opacity of the accent colour

/// Between frames.
struct TraceListState {
    TraceList list;
    TraceOrder order = TraceOrder::length;
    bool is_descending = true;
    bool shows_nodes = false;
};
TraceListState trace_lists;

std::string in_digits(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

/// Draws a cell with text and a square in the group's colour; a click on the cell selects the row.
void first_cell(const std::string& text, bool is_selected, uint8_t group, const Model& model, const Actions& selects,
                Actions& actions)
{
    ImGui::TableNextColumn();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float side = 0.7f * ImGui::GetFontSize();
    ImGui::Dummy({side, side});
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 0.2f * side}, {at.x + side, at.y + 1.2f * side},
                                              ImGui::GetColorU32(encoded(group_of(model.session.groups, group).color)),
                                              2.0f);
    ImGui::SameLine();
    ImGui::PushStyleColor(ImGuiCol_Header, ImGui::GetColorU32(ImGuiCol_SliderGrab, SELECTED_ALPHA));
    const bool is_clicked = ImGui::Selectable(text.c_str(), is_selected);
    ImGui::PopStyleColor();
    if (is_clicked) {
        const std::string why = why_not(model, selects.front());
        if (why.empty()) actions.insert(actions.end(), selects.begin(), selects.end());
    }
}

bool go_button()
{
    ImGui::TableNextColumn();
    const bool is_clicked = ImGui::SmallButton("Go");
    hint("The camera looks at it, from the same side as now, and it is selected.");
    return is_clicked;
}

void number_cell(const std::string& text)
{
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.c_str());
}

void segment_row(const SegmentRow& row, const Model& model, Actions& actions)
{
    ImGui::PushID(int(row.internode));
    ImGui::TableNextRow();
    const std::string name = std::to_string(row.first) + " to " + std::to_string(row.last) + "##segment";
    const Actions selects = select_segment(row);
    first_cell(name, is_selected(row, model.trace.selection()), row.group, model, selects, actions);
    const ColorGroup look = group_of(model.session.groups, row.group);
    hint(((row.is_mixed ? "Of several groups, most of it of group " : "Group ") + std::to_string(row.group) + ", " +
          look.name + ". From node " + std::to_string(row.first) + " to node " + std::to_string(row.last) +
          ". A click selects it.")
             .c_str());
    number_cell(std::to_string(row.group) + (row.is_mixed ? "+" : ""));
    number_cell(std::to_string(row.nodes));
    number_cell(in_digits(row.length));
    if (go_button()) {
        actions.push_back(go_to(row, model.volume.spacing));
        actions.insert(actions.end(), selects.begin(), selects.end());
    }
    ImGui::PopID();
}

void node_row(const NodeRow& row, const Model& model, Actions& actions)
{
    ImGui::PushID(int(row.node));
    ImGui::TableNextRow();
    const Actions selects = select_node(row);
    first_cell(std::to_string(row.node) + "##node", model.trace.selection().node() == row.node, row.group, model,
               selects, actions);
    hint("A click selects it.");
    number_cell(std::to_string(row.group));
    number_cell(std::to_string(row.internodes));
    number_cell(in_digits(row.radius));
    if (go_button()) {
        actions.push_back(go_to(row, model.trace, model.volume.spacing));
        actions.insert(actions.end(), selects.begin(), selects.end());
    }
    ImGui::PopID();
}

/// Sorts by the heading that was clicked; a second click on the same heading reverses the order.
void take_order()
{
    ImGuiTableSortSpecs* const specs = ImGui::TableGetSortSpecs();
    if (!specs || !specs->SpecsDirty || specs->SpecsCount == 0) return;
    specs->SpecsDirty = false;
    constexpr TraceOrder ORDERS[] = {TraceOrder::number, TraceOrder::group, TraceOrder::nodes, TraceOrder::length};
    trace_lists.order = ORDERS[specs->Specs[0].ColumnIndex];
    trace_lists.is_descending = specs->Specs[0].SortDirection == ImGuiSortDirection_Descending;
}

void set_up_columns(bool shows_nodes)
{
    const auto fixed = [](const std::string& name, float width, ImGuiTableColumnFlags flags = 0) {
        ImGui::TableSetupColumn(name.c_str(), ImGuiTableColumnFlags_WidthFixed | flags, width * ImGui::GetFontSize());
    };
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn(shows_nodes ? "Node" : "Ends", ImGuiTableColumnFlags_WidthStretch);
    fixed("Group", 3.8f);
    fixed(shows_nodes ? "Internodes" : "Nodes", shows_nodes ? 5.2f : 3.8f);
    fixed(shows_nodes ? "Radius" : "Length", 4.6f,
          ImGuiTableColumnFlags_PreferSortDescending | ImGuiTableColumnFlags_DefaultSort);
    fixed("", 2.0f, ImGuiTableColumnFlags_NoSort);
    ImGui::TableHeadersRow();
}

void trace_table(const Model& model, Actions& actions)
{
    const bool shows_nodes = trace_lists.shows_nodes;
    const size_t rows = shows_nodes ? trace_lists.list.nodes().size() : trace_lists.list.segments().size();
    const float line = ImGui::GetTextLineHeight() + 2.0f * ImGui::GetStyle().CellPadding.y;
    const float height = line * (std::min(float(rows), MAX_TRACE_LINES) + 1.4f);
    ImGuiTableFlags flags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg;
    if (!shows_nodes) flags |= ImGuiTableFlags_Sortable;
    if (!ImGui::BeginTable(shows_nodes ? "nodes" : "segments", 5, flags, {0.0f, height})) return;
    set_up_columns(shows_nodes);
    if (!shows_nodes) take_order();
    ImGuiListClipper clipper;
    clipper.Begin(int(rows), line);
    while (clipper.Step())
        for (int at = clipper.DisplayStart; at < clipper.DisplayEnd; ++at) {
            if (shows_nodes)
                node_row(trace_lists.list.nodes()[size_t(at)], model, actions);
            else
                segment_row(trace_lists.list.segments()[size_t(at)], model, actions);
        }
    ImGui::EndTable();
}

}  // namespace

void trace_list_panel(const Model& model, Actions& actions)
{
    if (model.trace.nodes().empty()) {
        ImGui::TextWrapped(
            "Nothing is traced yet. Choose the tool Trace: a click then adds a node, linked with the selected one.");
        return;
    }
    trace_lists.list.update(model.trace, trace_lists.order, trace_lists.is_descending);
    if (ImGui::RadioButton("Segments", !trace_lists.shows_nodes)) trace_lists.shows_nodes = false;
    hint("Chains of internodes between two branches or ends.");
    ImGui::SameLine();
    if (ImGui::RadioButton("Nodes", trace_lists.shows_nodes)) trace_lists.shows_nodes = true;
    ImGui::SameLine();
    ImGui::TextDisabled("in %s", model.volume.unit == "voxel" ? "voxels" : spelled(model.volume.unit));
    hint("Unit of lengths and radii.");
    trace_table(model, actions);
}

}  // namespace shvr::ui
