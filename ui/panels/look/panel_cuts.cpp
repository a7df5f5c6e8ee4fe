// Cutting planes of the volume and clip planes of the camera, edited as numbers.

#include <algorithm>
#include <cmath>

#include <imgui/imgui.h>

#include "engine/workbench/edits/edit.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char* AXIS_NAMES[] = {"x", "y", "z"};

/// Draws one plane's position, shown in units of `scale` voxels. Returns whether the plane was moved.
bool plane(const char* id, double& voxels, double least, double most, double scale, const char* format)
{
    double value = voxels * scale;
    const double lowest = least * scale, highest = most * scale;
    ImGui::SetNextItemWidth(-1.0f);
    const double speed = std::max((highest - lowest) / 300.0, 1e-9);
    if (!drag_number(id, value, speed, lowest, highest, format)) return false;
    voxels = value / scale;
    return true;
}

/// Draws a table row: the visible range of the volume along one axis.
bool axis_row(int axis, CutBox& cut, double size, double scale, const char* unit, const char* format)
{
    ImGui::PushID(unit);
    ImGui::PushID(axis);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(AXIS_NAMES[axis]);
    ImGui::TableNextColumn();
    bool is_other = plane("##from", cut.lower[axis], 0.0, cut.upper[axis], scale, format);
    hint("Nothing before this is drawn. Drag sideways, or Ctrl + click to type.");
    ImGui::TableNextColumn();
    is_other |= plane("##to", cut.upper[axis], cut.lower[axis], size, scale, format);
    hint("Nothing beyond this is drawn. Drag sideways, or Ctrl + click to type.");
    ImGui::TableNextColumn();
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", unit);
    ImGui::PopID();
    ImGui::PopID();
    return is_other;
}

void cutting_planes(const Model& model, Actions& actions)
{
    const glm::dvec3 size(model.volume.size);
    CutBox cut = model.session.cut;
    cut.upper = glm::min(cut.upper, size);
    bool is_other = false;
    if (ImGui::BeginTable("cuts", 4, ImGuiTableFlags_SizingStretchSame)) {
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, ImGui::GetFontSize());
        ImGui::TableSetupColumn("from");
        ImGui::TableSetupColumn("to");
        ImGui::TableSetupColumn("in", ImGuiTableColumnFlags_WidthFixed, 3.2f * ImGui::GetFontSize());
        ImGui::TableHeadersRow();
        for (int axis = 0; axis < 3; ++axis) is_other |= axis_row(axis, cut, size[axis], 1.0, "voxels", "%.1f");
        if (model.volume.unit != "voxel")
            for (int axis = 0; axis < 3; ++axis)
                is_other |=
                    axis_row(axis, cut, size[axis], model.volume.spacing[axis], spelled(model.volume.unit), "%.5g");
        ImGui::EndTable();
    }
    // The displayed planes are clamped to the volume; planes that the user has not moved keep their stored positions.
    for (int axis = 0; axis < 3; ++axis)
        if (cut.upper[axis] == size[axis] && model.session.cut.upper[axis] >= size[axis])
            cut.upper[axis] = model.session.cut.upper[axis];
    if (is_other) set(actions, model, [&](Session& s) { s.cut = cut; });
    const bool is_cut = !(model.session.cut == CutBox{});
    ImGui::BeginDisabled(!is_cut);
    if (ImGui::Button("Show everything")) set(actions, model, [](Session& s) { s.cut = {}; });
    ImGui::EndDisabled();
    hint("All six cutting planes back to the volume's faces, and no oblique one.");
    ImGui::SameLine();
    bool has_box = model.session.view.cut_box;
    if (ImGui::Checkbox("Clip box with handles", &has_box))
        set(actions, model, [&](Session& s) { s.view.cut_box = has_box; });
    hint(
        "Lines along the edges of the uncut part, in the colours of the axes, and a handle for each of its faces: drag "
        "them in the volume or in a slice.");
}

/// Draws the numbers of the oblique cutting plane: its direction, and its distance from the volume's middle.
void oblique_numbers(const Model& model, Actions& actions)
{
    CutBox cut = model.session.cut;
    const glm::dvec3& spacing = model.volume.spacing;
    const glm::dvec3 middle = 0.5 * glm::dvec3(model.volume.size);
    glm::dvec3 normal = glm::normalize(*cut.plane_normal);
    const glm::dvec3 point = cut.plane_point.value_or(middle);
    bool is_other = false;
    row("Direction");
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
    const float width = (ImGui::GetContentRegionAvail().x - 2.0f * gap) / 3.0f;
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) ImGui::SameLine(0.0f, gap);
        ImGui::SetNextItemWidth(width);
        is_other |= drag_number(sentence("##", AXIS_NAMES[axis], " of the direction").c_str(), normal[axis], 0.005,
                                -1.0, 1.0, "%.3f");
        hint("Direction in which the plane removes the volume, along x, y and z, in the unit of length.");
    }
    if (is_other && glm::length(normal) > 1e-3) cut.plane_normal = glm::normalize(normal);
    const double reach = 0.5 * glm::length(glm::dvec3(model.volume.size) * spacing);
    double offset = glm::dot((point - middle) * spacing, glm::normalize(*cut.plane_normal));
    if (std::abs(offset) < 1e-9 * reach) offset = 0.0;  // a rounding error
    const std::string format = std::string("%.5g ") + spelled(model.volume.unit);
    row("Offset");
    if (drag_number("##offset", offset, reach / 300.0, -reach, reach, format.c_str())) {
        is_other = true;
        cut.plane_point = middle + offset * glm::normalize(*cut.plane_normal) / spacing;
    }
    hint("Distance of the plane from the volume's middle, towards what it removes.");
    if (is_other) set(actions, model, [&](Session& s) { s.cut = cut; });
}

/// Draws the buttons of the oblique cutting plane and, if there is one, its numbers.
void oblique_plane(const Model& model, Actions& actions)
{
    const bool has_plane = model.session.cut.plane_normal.has_value();
    if (ImGui::Button(has_plane ? "Face the view" : "Oblique cutting plane"))
        actions.push_back(CutObliquely{PlaneChange::add});
    hint(
        "A cutting plane through the middle of the view that removes the half towards you. Drag its handles, in the "
        "volume or in a slice: the one at the tip of the normal tilts it, the other moves it.");
    if (!has_plane) return;
    ImGui::SameLine();
    if (ImGui::Button("Flip")) actions.push_back(CutObliquely{PlaneChange::flip});
    hint("Removes the other side.");
    ImGui::SameLine();
    if (ImGui::Button("Remove")) actions.push_back(CutObliquely{PlaneChange::remove});
    ImGui::SameLine();
    bool has_handles = model.session.view.plane_handles;
    if (ImGui::Checkbox("Handles", &has_handles))
        set(actions, model, [&](Session& s) { s.view.plane_handles = has_handles; });
    oblique_numbers(model, actions);
}

/// Draws a clip plane's distance from the eye; 0 means no plane.
bool clip(const char* name, double& distance, double reach, const char* none, const char* format, const char* help)
{
    row(name);
    const bool is_other = drag_number(sentence("##", name).c_str(), distance, reach / 300.0, 0.0, 100.0 * reach,
                                      distance > 0.0 ? format : none);
    hint(help);
    return is_other;
}

void clip_planes(const Model& model, Actions& actions)
{
    double near = model.camera.near_distance, far = model.camera.far_distance;
    const double reach = glm::distance(model.camera.eye, model.camera.target);
    const std::string format = std::string("%.5g ") + spelled(model.volume.unit);
    bool is_other = clip("Near clip", near, reach, "none", format.c_str(),
                         "Nothing nearer to the eye than this is drawn. Drag sideways, or Ctrl + click to type; 0: no "
                         "plane.");
    if (is_other && far > 0.0) near = std::min(near, 0.999 * far);
    const bool is_far_other = clip("Far clip", far, reach, "none", format.c_str(),
                                   "Nothing farther from the eye than this is drawn. 0: no plane.");
    if (is_far_other && far > 0.0) far = std::max(far, near * 1.001 + 1e-9 * reach);
    if (is_other || is_far_other) actions.push_back(PlaceClips{near, far});
    ImGui::BeginDisabled(near == 0.0 && far == 0.0);
    if (ImGui::Button("No clip planes")) actions.push_back(PlaceClips{});
    ImGui::EndDisabled();
}

}  // namespace

void cuts_panel(const Model& model, Actions& actions)
{
    cutting_planes(model, actions);
    ImGui::Separator();
    oblique_plane(model, actions);
    ImGui::Separator();
    clip_planes(model, actions);
}

}  // namespace shvr::ui
