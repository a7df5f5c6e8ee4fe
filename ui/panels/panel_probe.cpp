#include "ui/panels/panels.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>

#include <imgui/imgui.h>

#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Integer intensities need no decimals.
const char* format_of(VoxelType type)
{
    return is_float(type) ? "%.4g" : "%.0f";
}

bool intensity_slider(const char* id, const Model& model, double& intensity)
{
    const auto [lower, upper] = model.statistics.range();
    ImGui::SetNextItemWidth(-1.0f);
    return slider_scalar(id, ImGuiDataType_Double, &intensity, &lower, &upper, format_of(model.volume.type));
}

// ---- Painting

bool brush_kind(BrushSettings& brush)
{
    bool changed = false;
    for (const BrushRow& row : BRUSHES) {
        if (row.brush != BRUSHES.front().brush) ImGui::SameLine();
        if (ImGui::RadioButton(row.title, brush.brush == row.brush)) {
            brush.brush = row.brush;
            changed = true;
        }
        hint(row.hint);
    }
    return changed;
}

bool region_shape(BrushSettings& brush)
{
    const RegionShape was = brush.region;
    label("Shape");
    if (ImGui::RadioButton("Ball", was == RegionShape::ball)) brush.region = RegionShape::ball;
    hint("The brush reaches equally far in all directions.");
    ImGui::SameLine();
    if (ImGui::RadioButton("Box", was == RegionShape::box)) brush.region = RegionShape::box;
    hint("The brush is a box along the volume's axes.");
    return brush.region != was;
}

bool radius(const Model& model, BrushSettings& brush, Actions& actions)
{
    label("Radius");
    ImGui::SetNextItemWidth(8.0f * ImGui::GetFontSize());
    const bool changed = drag_number("##radius", brush.radius_voxels, 0.15, MIN_RADIUS_VOXELS, MAX_RADIUS_VOXELS,
                                     "%.1f voxels", ImGuiSliderFlags_Logarithmic);
    hint(sentence("Radius of the probe and the brush. Drag sideways, or Ctrl + click to type. ",
                  name_with_key("larger_brush", model.keymap), ", ", name_with_key("smaller_brush", model.keymap), ".")
             .c_str());
    if (resets("probe.radius_voxels", actions)) return false;
    if (model.volume.unit == "voxel") return changed;
    ImGui::SameLine();
    ImGui::TextDisabled("= %.4g %s", brush.radius_voxels * model.volume.spacing.x, spelled(model.volume.unit));
    return changed;
}

bool threshold(const Model& model, BrushSettings& brush, Actions& actions)
{
    label("Paint threshold");
    const bool changed = intensity_slider("##threshold", model, *brush.threshold);
    hint(sentence(
             "In the file's intensities: only voxels at or above it are painted. The line \"paint\" in the transfer "
             "function. ",
             name_with_key("threshold_here", model.keymap), ".")
             .c_str());
    return !resets("probe.paint_threshold", actions) && changed;
}

bool connectivity(BrushSettings& brush)
{
    const int was = brush.connectivity;
    label("Neighbours");
    if (ImGui::RadioButton("6 (faces)", was == 6)) brush.connectivity = 6;
    hint("Voxels are connected where they share a face.");
    ImGui::SameLine();
    if (ImGui::RadioButton("26 (all around)", was == 26)) brush.connectivity = 26;
    hint("Voxels are connected where they share a face, an edge or a corner: follows thin slanting roots.");
    return brush.connectivity != was;
}

/// Settings of density painting, which makes faint structures as visible as bright ones.
bool density(const Model& model, BrushSettings& brush)
{
    bool is_on = brush.density.has_value();
    label("Density painting");
    bool changed = ImGui::Checkbox("raises intensities", &is_on);
    hint(
        "Raises the intensities of what is painted, so that faint structures look like bright "
        "ones. The volume's file stays as it is; the eraser takes offsets away.");
    if (changed) {
        brush.density = is_on ? std::optional(DensityBrush{}) : std::nullopt;
        brush.paints_group = true;
    }
    if (!brush.density) return changed;
    label("");
    changed |= ImGui::Checkbox("and paints the group", &brush.paints_group);
    hint("Off: raises intensities and leaves groups as they are.");

    label("Raise by");
    const double automatic = automatic_offset(model.session.transfer_function.lower(), *brush.threshold);
    bool is_automatic = !brush.density->offset;
    if (ImGui::Checkbox("automatic", &is_automatic)) {
        brush.density->offset = is_automatic ? std::nullopt : std::optional(automatic);
        changed = true;
    }
    hint("As much as makes the paint threshold visible: the transfer function's lowest point minus the threshold.");
    ImGui::SameLine();
    double offset = brush.density->offset.value_or(automatic);
    ImGui::BeginDisabled(is_automatic);
    ImGui::SetNextItemWidth(-1.0f);
    const auto [lower, upper] = model.statistics.range();
    const double most = upper - lower, least = -most;
    if (drag_number("##offset", offset, most / 400.0, least, most, format_of(model.volume.type))) {
        brush.density->offset = offset;
        changed = true;
    }
    ImGui::EndDisabled();
    if (is_automatic && automatic == 0.0) {
        ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
        ImGui::TextWrapped("Nothing to raise: the paint threshold is visible already. Lower it, or enter a number.");
        ImGui::PopStyleColor();
    }

    label("Falls off");
    if (ImGui::RadioButton("not at all", brush.density->falloff == Falloff::flat)) {
        brush.density->falloff = Falloff::flat;
        changed = true;
    }
    ImGui::SameLine();
    if (ImGui::RadioButton("to the edge", brush.density->falloff == Falloff::distance)) {
        brush.density->falloff = Falloff::distance;
        changed = true;
    }
    return changed;
}

void preview(const Model& model, Actions& actions)
{
    bool is_on = model.session.probe.preview.value_or(true);
    label("Preview");
    if (ImGui::Checkbox(sentence("show changes", key_in_brackets("preview", model.keymap), "##preview").c_str(),
                        &is_on))
        set(actions, model, [&](Session& s) { s.probe.preview = is_on ? std::nullopt : std::optional(false); });
    hint("Shows the voxels that painting would change here; striped where it would erase.");
    if (!is_on) return;
    label("");
    if (model.tool() == Tool::trace)
        ImGui::TextDisabled("not while tracing");
    else if (!model.session.probe.previews())
        ImGui::TextDisabled("with the tools Paint and Erase");
    else if (model.previewed_voxels)
        ImGui::Text("%lld voxels would change", static_cast<long long>(*model.previewed_voxels));
}

/// Draws the choice of voxels that the brush leaves unchanged.
bool spared(BrushSettings& brush)
{
    label("Paints");
    ImGui::BeginDisabled(!brush.paints_group || brush.group == 0);
    const bool changed = ImGui::Checkbox("only unpainted voxels", &brush.only_unpainted);
    ImGui::EndDisabled();
    hint("Takes no voxel from another group. Single groups can be locked in the list of groups.");
    return changed;
}

void painting(const Model& model, Actions& actions)
{
    BrushSettings brush = model.brush();
    bool changed = brush_kind(brush);
    changed |= region_shape(brush);
    changed |= radius(model, brush, actions);
    changed |= threshold(model, brush, actions);
    ImGui::BeginDisabled(!row_of(brush.brush).is_connected);
    changed |= connectivity(brush);
    ImGui::EndDisabled();
    changed |= spared(brush);
    changed |= density(model, brush);
    if (changed) set(actions, model, [&](Session& s) { s.probe.brush = brush; });
    preview(model, actions);
}

}  // namespace

void probe_panel(const Model& model, Actions& actions)
{
    painting(model, actions);
}

}  // namespace shvr::ui
