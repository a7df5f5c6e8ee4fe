// Measurements: what the tool measures, and the list of what is measured, with names and values.

#include <algorithm>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/sight/words.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

struct KindRow {
    MeasureKind kind;
    const char *title, *how;
};
constexpr KindRow KIND_ROWS[] = {
    {MeasureKind::distance, "Distance", "Click two points in the picture, or drag from one to the other."},
    {MeasureKind::path, "Path", "Click points along the structure; a double click ends the path."},
    {MeasureKind::angle, "Angle", "Click a side, the vertex, and the other side."},
};

/// Draws the kinds; choosing one takes the tool, too.
void kinds(const Model& model, Actions& actions)
{
    const bool is_in_hand = model.tool() == Tool::measure;
    for (const KindRow& row : KIND_ROWS) {
        if (row.kind != MeasureKind::distance) ImGui::SameLine();
        if (ImGui::RadioButton(row.title, is_in_hand && model.session.probe.measure == row.kind))
            set(actions, model, [&](Session& s) {
                s.probe.measure = row.kind;
                s.probe.tool = Tool::measure;
            });
        hint(row.how);
    }
    if (!is_in_hand) return;
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped("%s", KIND_ROWS[size_t(model.session.probe.measure)].how);
    ImGui::PopStyleColor();
}

/// Draws a button of an action, which is grey while the action is unavailable.
void button(const char* text, const Action& action, const Model& model, Actions& actions)
{
    ImGui::BeginDisabled(!why_not(model, action).empty());
    if (ImGui::Button(text)) actions.push_back(action);
    ImGui::EndDisabled();
}

/// Draws a name, which can be typed over.
void name_cell(size_t number, const std::string& name, Actions& actions)
{
    ImGui::SetNextItemWidth(-1.0f);
    if (const auto renamed = name_field("##name", name)) actions.push_back(RenameMeasurement{number, *renamed});
    hint("Click to type another name.");
}

void measurement_row(size_t number, const Model& model, Actions& actions)
{
    const Measurement& measured = model.measurements[number - 1];
    ImGui::PushID(int(number));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    name_cell(number, name_of(measured, number), actions);
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(value_in_words(measured, model.volume).c_str());
    ImGui::TableNextColumn();
    if (ImGui::SmallButton("Go")) actions.push_back(GoTo{measured.points[measured.points.size() / 2]});
    hint("The probe and the slices go to its middle point.");
    ImGui::TableNextColumn();
    if (ImGui::SmallButton("x")) actions.push_back(RemoveMeasurement{number});
    hint("Removes it. Undo brings it back.");
    ImGui::PopID();
}

void list(const Model& model, Actions& actions)
{
    constexpr float MAX_LINES = 10.0f;
    const float line = ImGui::GetFrameHeight() + 2.0f * ImGui::GetStyle().CellPadding.y;
    const float height = line * std::min(float(model.measurements.size()), MAX_LINES) + 4.0f;
    if (!ImGui::BeginTable("measurements", 4, ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg, {0.0f, height})) return;
    const float font = ImGui::GetFontSize();
    ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("Value", ImGuiTableColumnFlags_WidthFixed, 7.0f * font);
    ImGui::TableSetupColumn("##go", ImGuiTableColumnFlags_WidthFixed, 2.0f * font);
    ImGui::TableSetupColumn("##remove", ImGuiTableColumnFlags_WidthFixed, 1.4f * font);
    ImGuiListClipper clipper;
    clipper.Begin(int(model.measurements.size()), line);
    while (clipper.Step())
        for (int at = clipper.DisplayStart; at < clipper.DisplayEnd; ++at)
            measurement_row(size_t(at) + 1, model, actions);
    ImGui::EndTable();
}

}  // namespace

void measurements_panel(const Model& model, Actions& actions)
{
    kinds(model, actions);
    if (model.session.probe.measure == MeasureKind::path && !model.measuring.empty())
        button("End the path", EndMeasure{}, model, actions);
    if (model.measurements.empty()) {
        ImGui::TextDisabled("Nothing is measured yet.");
        return;
    }
    list(model, actions);
    button("Copy", CopyMeasurements{}, model, actions);
    hint("Puts the table onto the clipboard, for a spreadsheet.");
    ImGui::SameLine();
    if (ImGui::Button("Export...")) actions.push_back(ShowDialog{Dialog::export_work});
    hint("Writes the table to a file, with the unit in the headings.");
    ImGui::SameLine();
    button("Remove all", ClearMeasurements{}, model, actions);
}

}  // namespace shvr::ui
