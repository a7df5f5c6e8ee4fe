#include "ui/panels/panels.h"

#include <algorithm>
#include <cstring>
#include <string>

#include <imgui/imgui.h>

#include "ui/workbench/keymap.h"

namespace shvr::ui {

namespace {

struct Gesture {
    const char* what;
    const char* meaning;
};
constexpr Gesture GESTURES[] = {
    {"Left drag", "Turn the volume"},
    {"Middle drag, Shift + left drag", "Move the volume"},
    {"Wheel", "Zoom"},
    {"Ctrl + wheel", "Push the probe away or pull it closer"},
    {"Mouse without buttons", "The probe follows, in its plane"},
    {"Double click", "Put the probe onto what you see there"},
    {"Right button held", "Paint; when tracing, add a node"},
    {"Drop a file", "Open it"},
};

void heading(const char* text)
{
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::Spacing();
    ImGui::TextColored(ImGui::GetStyleColorVec4(ImGuiCol_CheckMark), "%s", text);
    ImGui::TableNextColumn();
}

void row(const char* left, const char* right)
{
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(left);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(right);
}

bool begin_list(const char* id)
{
    if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_SizingFixedFit)) return false;
    ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableSetupColumn("meaning", ImGuiTableColumnFlags_WidthStretch);
    return true;
}

/// The shortcuts under headings; the table is ordered by group.
void key_list(std::span<const Shortcut> listed, const Keymap& keymap)
{
    const char* group = "";
    for (const Shortcut& shortcut : listed) {
        if (std::strcmp(group, shortcut.group) != 0) heading(group = shortcut.group);
        row(keymap.text_of(shortcut).c_str(), shortcut.name);
    }
}

void mouse_list()
{
    heading("Mouse");
    for (const Gesture& gesture : GESTURES) row(gesture.what, gesture.meaning);
}

/// The first shortcut of a group near the middle, so that both columns are about equally long.
size_t middle(std::span<const Shortcut> listed)
{
    size_t at = listed.size() / 2 + std::size(GESTURES) / 2;
    while (at < listed.size() && std::strcmp(listed[at - 1].group, listed[at].group) == 0) ++at;
    return std::min(at, listed.size());
}

void both_columns(const Keymap& keymap)
{
    const std::span<const Shortcut> listed = shortcuts();
    const size_t split = middle(listed);
    ImGui::TableNextColumn();
    if (begin_list("left")) {
        key_list(listed.first(split), keymap);
        ImGui::EndTable();
    }
    ImGui::TableNextColumn();
    if (begin_list("right")) {
        mouse_list();
        key_list(listed.subspan(split), keymap);
        ImGui::EndTable();
    }
}

}  // namespace

void help_window(const Model& model, Actions& actions)
{
    bool is_open = model.shows_help;
    const float font = ImGui::GetFontSize();
    const ImGuiViewport& viewport = *ImGui::GetMainViewport();
    const ImVec2 size{std::min(64.0f * font, viewport.WorkSize.x), std::min(54.0f * font, viewport.WorkSize.y)};
    ImGui::SetNextWindowSize(size, ImGuiCond_Appearing);
    ImGui::SetNextWindowPos(viewport.GetWorkCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    if (ImGui::Begin("Keys and mouse", &is_open, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
        ImGui::TextDisabled("Keys for turning, moving and cutting repeat while held; with Shift slowly.");
        if (ImGui::BeginTable("columns", 2)) {
            ImGui::TableSetupColumn("left", ImGuiTableColumnFlags_WidthStretch, 0.42f);
            ImGui::TableSetupColumn("right", ImGuiTableColumnFlags_WidthStretch, 0.58f);
            both_columns(model.keymap);
            ImGui::EndTable();
        }
    }
    ImGui::End();
    if (!is_open) actions.push_back(ShowHelp{false});
}

}  // namespace shvr::ui
