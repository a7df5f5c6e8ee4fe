// The dialog that states what loading a file will change, before the file is loaded.

#include <algorithm>
#include <string>

#include <imgui/imgui.h>

#include "engine/workbench/lists/group_list.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/imgui_keys.h"
#include "ui/panels/panels.h"
#include "ui/panels/style.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char* PREVIEW = "Load annotation?";
constexpr size_t MAX_ROWS_SHOWN = 12;  ///< the table scrolls beyond

FileUse use_of(const LoadPreview& preview)
{
    return !preview.part                    ? FileUse::look
           : *preview.part == Part::mask    ? FileUse::mask
           : *preview.part == Part::offsets ? FileUse::offsets
                                            : FileUse::trace;
}

void count_cell(int64_t voxels, const char* sign)
{
    ImGui::TableNextColumn();
    if (voxels > 0) ImGui::Text("%s%lld", sign, static_cast<long long>(voxels));
}

/// Draws a row for each group that gains or loses voxels.
void group_table(const Groups& groups, const LoadPreview& preview)
{
    const float rows = float(std::min(preview.groups.size(), MAX_ROWS_SHOWN)) + 1.5f;
    constexpr ImGuiTableFlags FLAGS = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_ScrollY;
    if (!ImGui::BeginTable("changes", 5, FLAGS, {0.0f, rows * ImGui::GetFrameHeight()})) return;
    ImGui::TableSetupScrollFreeze(0, 1);
    for (const char* title : {"Group", "Voxels now", "Gained", "Lost", "Voxels then"}) ImGui::TableSetupColumn(title);
    ImGui::TableHeadersRow();
    for (const MaskPreview::Group& row : preview.groups) {
        ImGui::TableNextColumn();
        const glm::dvec3 color = group_of(groups, uint8_t(row.group)).color;
        const float side = ImGui::GetTextLineHeight();
        ImGui::PushID(row.group);
        ImGui::ColorButton("##color", {float(color.x), float(color.y), float(color.z), 1.0f},
                           ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop, {side, side});
        ImGui::PopID();
        ImGui::SameLine();
        ImGui::TextUnformatted(label_of_group(groups, uint8_t(row.group)).c_str());
        ImGui::TableNextColumn();
        ImGui::Text("%lld", static_cast<long long>(row.before));
        count_cell(row.gained, "+");
        count_cell(row.lost, "-");
        ImGui::TableNextColumn();
        ImGui::Text("%lld", static_cast<long long>(row.after()));
    }
    ImGui::EndTable();
}

}  // namespace

void load_preview_dialog(const Model& model, Actions& actions)
{
    if (!model.load_preview) return;
    const LoadPreview& preview = *model.load_preview;
    if (!ImGui::IsPopupOpen(PREVIEW)) ImGui::OpenPopup(PREVIEW);
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(44.0f * font, ImGui::GetMainViewport()->WorkSize.x), 0.0f});
    if (!ImGui::BeginPopupModal(PREVIEW, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(preview.path.c_str());
    ImGui::TextUnformatted(preview.changes.c_str());
    ImGui::PopTextWrapPos();
    if (!preview.groups.empty()) group_table(model.session.groups, preview);
    ImGui::PushTextWrapPos(0.0f);
    for (const std::string& note : preview.notes) ImGui::TextUnformatted(note.c_str());
    ImGui::TextDisabled("%s", preview.changes_anything ? "Undo takes it back." : " ");
    ImGui::PopTextWrapPos();
    const ImVec2 button{6.0f * font, 0.0f};
    ImGui::BeginDisabled(!preview.changes_anything);
    const bool loads = ImGui::Button("Load", button) || (preview.changes_anything && enter_confirms());
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool leaves = ImGui::Button("Cancel", button) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    if (loads)
        actions.push_back(LoadAnnotation{preview.path, use_of(preview)});
    else if (leaves)
        actions.push_back(PreviewLoad{});
    if (loads || leaves) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

}  // namespace shvr::ui
