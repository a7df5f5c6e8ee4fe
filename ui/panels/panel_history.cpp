// The steps of the history: the present step, undone steps, and where in the volume each step was made.

#include <algorithm>
#include <string>

#include <imgui/imgui.h>

#include "engine/base/error.h"
#include "engine/session/words/number_words.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/lists/history_list.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr float MAX_HISTORY_LINES = 14.0f;

/// Reason why the last requested step cannot be shown; empty: it can be shown.
std::string why_not_shown;

void show_where(const HistoryList& list, const Model& model, size_t row, Actions& actions)
{
    try {
        why_not_shown.clear();
        if (const auto place = place_of_row(list, model, row))
            actions.push_back(PlaceProbe{place->middle()});
        else
            why_not_shown = "'" + list.label_of(row) + "' is about the whole volume.";
    } catch (const Error& error) {
        why_not_shown = error.what();
    }
}

void step(const HistoryList& list, const Model& model, size_t row, Actions& actions)
{
    const bool is_present = row == list.present(), is_undone = row > list.present();
    ImGui::PushID(int(row));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(is_present ? ">" : "");
    ImGui::TableNextColumn();
    if (is_undone) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    const std::string shown = shortened(verbatim(capitalised(list.label_of(row))), ImGui::GetContentRegionAvail().x);
    const bool is_clicked = ImGui::Selectable(shown.c_str(), is_present);
    if (is_undone) ImGui::PopStyleColor();
    if (const auto action = go_to_row(list, row)) {
        const std::string why = why_not(model, *action);
        if (is_clicked && why.empty()) actions.push_back(*action);
        if (!why.empty())
            hint(why.c_str());
        else
            hint(is_undone ? "Undone. A click does it again, with all before it." : "A click undoes all after it.");
    } else {
        hint("This is where you are.");
    }
    ImGui::TableNextColumn();
    if (row > 0 && ImGui::SmallButton("Where")) show_where(list, model, row, actions);
    if (row > 0) hint("Moves the probe to the middle of this step's change.");
    ImGui::PopID();
}

}  // namespace

/// Draws the steps, newest first, since the present step is usually among the newest.
void history_panel(const Model& model, Actions& actions)
{
    const HistoryList list = history_list(model);
    const float line = ImGui::GetTextLineHeight() + 2.0f * ImGui::GetStyle().CellPadding.y;
    const float height = line * std::min(float(list.rows()), MAX_HISTORY_LINES) + 2.0f;
    const ImGuiTableFlags flags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_SizingFixedFit;
    if (ImGui::BeginTable("steps", 3, flags, {0.0f, height})) {
        ImGui::TableSetupColumn("present", ImGuiTableColumnFlags_WidthFixed, 0.6f * ImGui::GetFontSize());
        ImGui::TableSetupColumn("step", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("where", ImGuiTableColumnFlags_WidthFixed);
        ImGuiListClipper clipper;
        clipper.Begin(int(list.rows()), line);
        while (clipper.Step())
            for (int shown = clipper.DisplayStart; shown < clipper.DisplayEnd; ++shown)
                step(list, model, list.rows() - 1 - size_t(shown), actions);
        ImGui::EndTable();
    }
    if (!why_not_shown.empty()) ImGui::TextWrapped("%s", why_not_shown.c_str());
}

}  // namespace shvr::ui
