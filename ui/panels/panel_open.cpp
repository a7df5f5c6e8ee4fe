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

constexpr const char* SAVE_AS_TITLE = "Go on under another name";

struct PathDialog {
    bool is_asked_for = false;
    std::string path;
};
PathDialog opening, saving;

/// A dialog with one path. `says`: above it; `hint`: below. Returns whether the path was accepted.
bool path_dialog(PathDialog& dialog, const char* title, const char* verb, const char* says, const char* note)
{
    if (dialog.is_asked_for) ImGui::OpenPopup(title);
    const bool appears = std::exchange(dialog.is_asked_for, false);
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return false;
    ImGui::TextUnformatted(says);
    ImGui::SetNextItemWidth(36.0f * ImGui::GetFontSize());
    if (appears) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputText("##path", &dialog.path,
                                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    ImGui::TextDisabled("%s", note);
    const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
    ImGui::BeginDisabled(dialog.path.empty());
    const bool accepted = (ImGui::Button(verb, button) || entered) && !dialog.path.empty();
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool cancelled = ImGui::Button("Cancel", button) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    if (accepted || cancelled) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
    return accepted;
}

}  // namespace

void ask_for_file()
{
    opening.is_asked_for = true;
}

void open_dialog(Actions& actions)
{
    if (path_dialog(opening, OPEN_TITLE, "Open", "Path of a volume, a session (.json) or a project folder:",
                    "TIFF, DICOM, NIfTI, NRRD, MetaImage, OME-Zarr and raw; a file can also be dropped."))
        actions.push_back(Open{opening.path});
}

void ask_for_name(const Model& model)
{
    saving = {.is_asked_for = true,
              .path = std::filesystem::path(model.session_path).replace_extension().string() + "-2.json"};
}

void save_as_dialog(Actions& actions)
{
    if (path_dialog(saving, SAVE_AS_TITLE, "Save",
                    "Path of the new session (.json); mask, trace and history go with it:",
                    "The files so far stay as they are."))
        actions.push_back(SaveAs{saving.path});
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
