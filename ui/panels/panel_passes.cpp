// GPU time per pass of a picture, and use of device memory: a window for developers who measure.

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/lists/pass_log.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

struct PassesState {
    PassLog log;
    std::string graphed;  ///< name of the pass shown in the graph; empty: the sum of all passes
    std::string path = "passes.json";
};
PassesState passes_state;

void text_right(const std::string& text)
{
    const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
    if (room > 0.0f) ImGui::SetCursorPosX(ImGui::GetCursorPosX() + room);
    ImGui::TextUnformatted(text.c_str());
}

std::string printed(const char* format, double value)
{
    char text[48];
    std::snprintf(text, sizeof text, format, value);
    return text;
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

void row(const View::PassTime& pass, double most_ms, const PassRun* compared)
{
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const std::string graphed = pass.name == "all" ? std::string() : pass.name;
    if (ImGui::Selectable(pass.name.c_str(), passes_state.graphed == graphed, ImGuiSelectableFlags_SpanAllColumns))
        passes_state.graphed = graphed;
    hint("A click shows this step in the graph.");
    ImGui::TableNextColumn();
    if (pass.name != "all") {
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float share = most_ms > 0.0 ? float(pass.total_ms / most_ms) : 0.0f;
        const float width = std::max(ImGui::GetContentRegionAvail().x * share, 1.0f);
        ImGui::GetWindowDrawList()->AddRectFilled(at, {at.x + width, at.y + ImGui::GetTextLineHeight()},
                                                  ImGui::GetColorU32(ImGuiCol_PlotHistogram), 2.0f);
    }
    ImGui::TableNextColumn();
    text_right(printed("%.2f", pass.total_ms));
    ImGui::TableNextColumn();
    text_right(std::to_string(pass.runs));
    ImGui::TableNextColumn();
    text_right(pass.runs > 0 ? printed("%.3f", pass.total_ms / double(pass.runs)) : "-");
    ImGui::TableNextColumn();
    text_right(printed("%.2f", pass.longest_ms));
    if (!compared) return;
    ImGui::TableNextColumn();
    text_right(change_in_words(pass, *compared));
}

void heading(const char* name, const char* help)
{
    ImGui::TableNextColumn();
    ImGui::TableHeader(name);
    hint(help);
}

void table(const PassRun* compared)
{
    const std::vector<View::PassTime>& passes = passes_state.log.passes();
    const ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersOuterH | ImGuiTableFlags_PadOuterX |
                                  ImGuiTableFlags_SizingFixedFit;
    if (!ImGui::BeginTable("passes", compared ? 7 : 6, flags)) return;
    ImGui::TableSetupColumn("Step");
    ImGui::TableSetupColumn("bar", ImGuiTableColumnFlags_WidthStretch);
    for (int column = 0; column < (compared ? 5 : 4); ++column)
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    heading("Step", "A step of drawing a picture, as the program names it.");
    heading("", "Share of the slowest.");
    heading("ms", "Milliseconds on the GPU, of all runs since the picture began to change.");
    heading("runs", "How often it ran: a picture is drawn in many small pieces.");
    heading("ms/run", "Mean of a run.");
    heading("longest", "Milliseconds of the longest run. Input waits no longer than that for the GPU.");
    if (compared)
        heading("compared", "Milliseconds of all runs, relative to the saved ones: x 2.00 takes twice as long.");
    double most = 0.0;
    for (const View::PassTime& pass : passes) most = std::max(most, pass.total_ms);
    for (const View::PassTime& pass : passes) row(pass, most, compared);
    row(sum_of(passes), most, nullptr);
    ImGui::EndTable();
}

void graph()
{
    const std::vector<float> values = passes_state.log.graph(passes_state.graphed);
    if (values.empty()) return;
    const float most = *std::max_element(values.begin(), values.end());
    const std::string name = passes_state.graphed.empty() ? "all steps" : passes_state.graphed;
    const std::string text = name + ", at most " + printed("%.2f ms a frame", double(most));
    ImGui::PlotHistogram("##graph", values.data(), int(values.size()), 0, text.c_str(), 0.0f, std::max(most, 0.1f),
                         {ImGui::GetContentRegionAvail().x, 6.0f * ImGui::GetFontSize()});
    const std::string help = "Milliseconds on the GPU from one frame of the window to the next, over the last " +
                             printed("%.1f", passes_state.log.seconds()) +
                             " s in which something was drawn. Where nothing changes nothing is drawn.";
    hint(help.c_str());
}

/// Lists the allocations in device memory, the largest first.
void memory(const Model& model)
{
    constexpr double MEBIBYTE = 1024.0 * 1024.0;
    const std::string title = printed("Memory: %.1f", double(model.device_bytes) / MEBIBYTE) +
                              printed(" of %.0f MiB", double(model.device_budget) / MEBIBYTE) + "###memory";
    const bool is_open = ImGui::CollapsingHeader(title.c_str());
    hint("GPU memory in use, and the most that is used (shvr view --budget-device).");
    if (!is_open) return;
    std::vector<std::pair<uint64_t, std::string>> resources;
    for (const auto& [name, bytes] : model.bytes_by_name) resources.emplace_back(bytes, name);
    std::sort(resources.rbegin(), resources.rend());
    if (!ImGui::BeginTable("resources", 2, ImGuiTableFlags_RowBg | ImGuiTableFlags_PadOuterX)) return;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("KiB", ImGuiTableColumnFlags_WidthFixed);
    for (const auto& [bytes, name] : resources) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(name.c_str());
        ImGui::TableNextColumn();
        text_right(printed("%.0f KiB", double(bytes) / 1024.0));
    }
    ImGui::EndTable();
}

void comparison(const Model& model, Actions& actions)
{
    ImGui::SetNextItemWidth(14.0f * ImGui::GetFontSize());
    ImGui::InputText("##path", &passes_state.path);
    hint("A file of saved steps, or one that shvr profile --json has printed.");
    ImGui::SameLine();
    ImGui::BeginDisabled(passes_state.path.empty());
    if (ImGui::Button("Compare")) actions.push_back(ComparePasses{passes_state.path});
    ImGui::SameLine();
    if (ImGui::Button("Save")) actions.push_back(SavePasses{passes_state.path});
    ImGui::EndDisabled();
    if (!model.compared_passes) return;
    ImGui::Text("Compared with %s%s", model.compared_passes->name.c_str(),
                model.compared_passes->is_of_profile ? ", the median of a frame" : "");
    ImGui::SameLine();
    if (ImGui::SmallButton("No more")) actions.push_back(ComparePasses{});
}

}  // namespace

void passes_window(const Model& model, Actions& actions)
{
    place_kept_window("passes", {36.0, 34.0}, model);
    bool is_open = true;
    if (ImGui::Begin("GPU passes", &is_open, ImGuiWindowFlags_NoSavedSettings)) {
        keep_window("passes", model, actions);
        if (model.screen) passes_state.log.note(ImGui::GetTime(), model.screen->pass_times());
        ImGui::TextDisabled("%.*s", int(model.gpu_name.size()), model.gpu_name.data());
        hint("The GPU in use.");
        ImGui::SameLine();
        bool is_frozen = passes_state.log.is_frozen();
        if (ImGui::Checkbox("Freeze", &is_frozen)) passes_state.log.set_frozen(is_frozen);
        hint("Keeps the numbers and the graph as they are.");
        table(model.compared_passes);
        graph();
        comparison(model, actions);
        memory(model);
        ImGui::Text("Interface: %.1f ms a frame", model.ui_frame_ms);
        hint(
            "From the first call for a frame of the interface until the GPU is done with it; median of the last 31. "
            "Below 17 ms it feels smooth.");
    }
    ImGui::End();
    if (!is_open) actions.push_back(ShowPasses{false});
}

}  // namespace shvr::ui
