#include "ui/panels/panels.h"

#include <algorithm>
#include <cstdio>

#include <imgui/imgui.h>

#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

void text_right(const char* format, double value)
{
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text).x;
    if (room > 0.0f) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
    ImGui::TextUnformatted(text);
}

void row(const View::PassTime& pass)
{
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pass.name.c_str());
    hint(pass.name.c_str());
    ImGui::TableNextColumn();
    text_right("%.0f", double(pass.runs));
    ImGui::TableNextColumn();
    text_right("%.2f", pass.total_ms);
    ImGui::TableNextColumn();
    text_right("%.2f", pass.longest_ms);
}

View::PassTime sum_of(const std::vector<View::PassTime>& passes)
{
    View::PassTime sum{.name = "all"};
    for (const View::PassTime& pass : passes) {
        sum.runs += pass.runs;
        sum.total_ms += pass.total_ms;
        sum.longest_ms = std::max(sum.longest_ms, pass.longest_ms);
    }
    return sum;
}

void table(const std::vector<View::PassTime>& passes)
{
    const ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersOuterH | ImGuiTableFlags_PadOuterX;
    if (!ImGui::BeginTable("passes", 4, flags)) return;
    ImGui::TableSetupColumn("Pass", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("Runs", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableSetupColumn("Total ms", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableSetupColumn("Longest", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableHeadersRow();
    for (const View::PassTime& pass : passes) row(pass);
    row(sum_of(passes));
    ImGui::EndTable();
}

double mebibytes(uint64_t bytes)
{
    return double(bytes) / (1024.0 * 1024.0);
}

}  // namespace

void passes_panel(const Model& model, Actions&)
{
    ImGui::TextDisabled("Time on the GPU, by step (?)");
    hint("Of the current picture, which is drawn in many small pieces, so each step runs many times.");
    table(model.screen ? model.screen->pass_times() : std::vector<View::PassTime>());
    ImGui::TextWrapped("%.*s", int(model.gpu_name.size()), model.gpu_name.data());
    hint("The GPU in use.");
    ImGui::Text("Memory: %.0f of %.0f MiB", mebibytes(model.device_bytes), mebibytes(model.device_budget));
    hint("GPU memory in use, and how much SHVR may use.");
    ImGui::Text("Interface: %.1f ms a frame", model.ui_frame_ms);
    hint("Time that a frame of the interface takes, median of the last 31. Below 17 ms it feels smooth.");
}

}  // namespace shvr::ui
