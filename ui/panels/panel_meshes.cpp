// Meshes shown with the scan: visible or not, colour, file, and removal.

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/color_field.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr glm::dvec3 STANDARD_COLOR(0.578, 0.456, 0.262);  ///< linear; as drawn without a colour of the file

/// Empty: the mesh is drawn, is hidden, or is still being read.
std::string failure_of(const MeshLook& mesh, const Model& model)
{
    const auto failed = std::ranges::find(model.unshown_meshes, mesh.file, &std::pair<std::string, std::string>::first);
    return mesh.shown && failed != model.unshown_meshes.end() ? failed->second : "";
}

void mesh_row(size_t at, const Model& model, Actions& actions)
{
    const MeshLook& mesh = model.session.meshes[at];
    ImGui::PushID(int(at));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    bool is_shown = mesh.shown;
    if (ImGui::Checkbox("##shown", &is_shown)) set(actions, model, [&](Session& s) { s.meshes[at].shown = is_shown; });
    hint(is_shown ? "Hide it." : "Show it.");
    ImGui::TableNextColumn();
    glm::dvec3 color = mesh.color.value_or(STANDARD_COLOR);
    if (color_field("##color", color)) set(actions, model, [&](Session& s) { s.meshes[at].color = color; });
    hint(mesh.color ? "Its colour." : "Coloured as its file states. Choose a colour for all of it here.");
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    const std::string name = std::filesystem::path(mesh.file).filename().string();
    want_glyphs(name);
    const std::string failure = failure_of(mesh, model);
    if (failure.empty()) {
        ImGui::TextUnformatted(name.c_str());
        hint(mesh.file.c_str());
    } else {
        ImGui::TextColored(color_of(ColorRole::error), "%s: not drawn", name.c_str());
        hint((failure + ". Hide and show it to read it again.").c_str());
    }
    ImGui::TableNextColumn();
    if (ImGui::SmallButton("x"))
        set(actions, model, [&](Session& s) { s.meshes.erase(s.meshes.begin() + ptrdiff_t(at)); });
    hint("Removes it from the scan; the file stays. Undo brings it back.");
    ImGui::PopID();
}

}  // namespace

void meshes_panel(const Model& model, Actions& actions)
{
    if (model.session.meshes.empty()) {
        ImGui::TextWrapped(
            "Drop a mesh onto the picture (.stl, .ply, .obj or .glb), or load one, to see it with the scan.");
    } else if (ImGui::BeginTable("meshes", 4, ImGuiTableFlags_RowBg)) {
        ImGui::TableSetupColumn("##shown", ImGuiTableColumnFlags_WidthFixed);
        ImGui::TableSetupColumn("##color", ImGuiTableColumnFlags_WidthFixed);
        ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableSetupColumn("##remove", ImGuiTableColumnFlags_WidthFixed);
        for (size_t at = 0; at < model.session.meshes.size(); ++at) mesh_row(at, model, actions);
        ImGui::EndTable();
    }
    if (ImGui::Button("Load a mesh...")) actions.push_back(ShowDialog{Dialog::load});
    hint("Opens Load annotation, which also takes meshes.");
}

}  // namespace shvr::ui
