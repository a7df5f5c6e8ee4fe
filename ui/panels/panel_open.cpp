// Ways in: the dialog that asks for a file, and the page that is shown while nothing is open.

#include <algorithm>
#include <filesystem>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "ui/panels/panels.h"
#include "ui/workbench/preferences.h"

namespace shvr::ui {

namespace {

constexpr const char* OPEN_TITLE = "Open a volume or a session";

struct OpenDialog {
    bool is_asked_for = false;
    std::string path;
};
OpenDialog dialog;

}  // namespace

void ask_for_file()
{
    dialog.is_asked_for = true;
}

/// Call outside the menu, which is closed while this is open.
void open_dialog(Actions& actions)
{
    if (dialog.is_asked_for) ImGui::OpenPopup(OPEN_TITLE);
    const bool appears = std::exchange(dialog.is_asked_for, false);
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(OPEN_TITLE, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
    ImGui::TextUnformatted("Path of a volume, a session (.json) or a project folder:");
    ImGui::SetNextItemWidth(36.0f * ImGui::GetFontSize());
    if (appears) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputText("##path", &dialog.path,
                                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    ImGui::TextDisabled("TIFF, DICOM, NIfTI, NRRD, MetaImage, OME-Zarr and raw; a file can also be dropped.");
    const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
    ImGui::BeginDisabled(dialog.path.empty());
    const bool accepted = (ImGui::Button("Open", button) || entered) && !dialog.path.empty();
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool cancelled = ImGui::Button("Cancel", button) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    if (accepted) actions.push_back(Open{dialog.path});
    if (accepted || cancelled) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

void start_page(const Model& model, Actions& actions)
{
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(40.0f * font, ImGui::GetMainViewport()->WorkSize.x), 0.0f});
    ImGui::Begin("Start", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize);
    if (ImGui::Button("Open...", {8.0f * font, 0.0f})) ask_for_file();
    ImGui::SameLine();
    ImGui::TextDisabled("or drop a scan, a session or a project folder here");
    if (!model.preferences.recent.empty()) {
        ImGui::Spacing();
        ImGui::TextUnformatted("Opened last");
        for (const std::filesystem::path& path : model.preferences.recent)
            if (ImGui::Selectable(path.c_str())) actions.push_back(Open{path});
    }
    ImGui::End();
}

}  // namespace shvr::ui
