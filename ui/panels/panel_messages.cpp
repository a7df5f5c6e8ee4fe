// All messages, and a report of them for developers.

#include <vector>

#include <imgui/imgui.h>

#include "engine/workbench/lists/bug_report.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

enum class Shown { all, warnings, errors };

bool is_shown(const Message& message, Shown shown)
{
    return shown == Shown::all || message.weight == Weight::error ||
           (shown == Shown::warnings && message.weight == Weight::warning);
}

ImU32 color_of(Weight weight)
{
    return weight == Weight::error     ? ImU32(ERROR_TEXT)
           : weight == Weight::warning ? ImU32(WARNING)
                                       : ImGui::GetColorU32(ImGuiCol_Text);
}

void head(const Model& model, Shown& shown)
{
    for (const auto& [which, name] : {std::pair{Shown::all, "All"}, std::pair{Shown::warnings, "Warnings and errors"},
                                      std::pair{Shown::errors, "Errors"}}) {
        if (ImGui::RadioButton(name, shown == which)) shown = which;
        ImGui::SameLine();
    }
    const float width = 4.0f * ImGui::GetFontSize();
    ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(), ImGui::GetContentRegionMax().x - width));
    if (ImGui::Button("Copy", {width, 0.0f})) ImGui::SetClipboardText(bug_report(model).c_str());
    hint("Copies a bug report: version, device, session path, last actions and messages.");
}

/// Lists messages in columns (time, weight, text), newest at the bottom. Follows new messages unless scrolled away.
void list(const Model& model, Shown shown)
{
    const ImGuiTableFlags flags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit;
    if (!ImGui::BeginTable("messages", 3, flags)) return;
    ImGui::TableSetupColumn("time");
    ImGui::TableSetupColumn("weight");
    ImGui::TableSetupColumn("text", ImGuiTableColumnFlags_WidthStretch);
    for (const Message& message : model.messages.all()) {
        if (!is_shown(message, shown)) continue;
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", time_in_words(message).c_str());
        ImGui::PushStyleColor(ImGuiCol_Text, color_of(message.weight));
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(word_of(message.weight));
        ImGui::TableNextColumn();
        ImGui::TextWrapped("%s", message.text.c_str());
        ImGui::PopStyleColor();
    }
    static uint64_t scrolled_to = 0;
    if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY() || scrolled_to != model.messages.count()) {
        ImGui::SetScrollHereY(1.0f);
        scrolled_to = model.messages.count();
    }
    ImGui::EndTable();
}

}  // namespace

void messages_window(const Model& model, Actions& actions)
{
    static Shown shown = Shown::all;
    bool is_open = true;
    place_kept_window("messages", {52.0, 22.0}, model);
    if (ImGui::Begin("Messages", &is_open, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
        keep_window("messages", model, actions);
        head(model, shown);
        list(model, shown);
    }
    ImGui::End();
    if (!is_open) actions.push_back(ShowMessages{false});
}

}  // namespace shvr::ui
