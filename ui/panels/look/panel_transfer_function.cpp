// The panel of the transfer function: presets, the curve (transfer_curve_widget.h), and fields for its points.

#include "ui/panels/panels.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/edits/edit.h"
#include "ui/panels/color_field.h"
#include "ui/panels/look/panel_presets.h"
#include "ui/panels/look/transfer_curve_widget.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

std::string digits(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, value == std::floor(value) && std::abs(value) < 1e9 ? "%.0f" : "%.4g", value);
    return text;
}

/// Draws buttons that select, add and remove points without the mouse, at the end of the line.
void point_buttons(const Model& model, CurveState& state, Actions& actions)
{
    TransferCurve curve(model.session.transfer_function);
    const size_t count = curve.points().size();
    const std::string place = sentence("Point ", state.selected + 1, " of ", count, " is selected. ");
    const auto button = [&](const char* name, bool is_possible, const char* meaning) {
        ImGui::SameLine();
        ImGui::BeginDisabled(!is_possible);
        const bool is_pressed = ImGui::Button(name);
        ImGui::EndDisabled();
        hint((place + meaning).c_str());
        return is_pressed;
    };
    if (button("<##point", state.selected > 0, "Selects the previous point.")) --state.selected;
    if (button(">##point", state.selected + 1 < count, "Selects the next point.")) ++state.selected;
    if (button("+##point", true, "Adds a point half-way to the next; at the last, to the previous.")) {
        const size_t right = std::min(state.selected + 1, count - 1);
        const ControlPoint &a = curve.points()[right - 1], &b = curve.points()[right];
        state.selected = curve.add(std::midpoint(a.intensity, b.intensity), std::midpoint(a.opacity, b.opacity));
        send(curve, model, actions);
    }
    if (button("-##point", count > 2, "Removes the point; at least two remain.")) {
        state.selected = curve.remove(state.selected);
        send(curve, model, actions);
    }
}

/// The line below the curve.
void scale_and_help(const Model& model, CurveState& state, Actions& actions)
{
    ImGui::Checkbox("Logarithmic", &state.is_logarithmic);
    std::string bins =
        "Height of the histogram's bars: the logarithm of the number of voxels, which shows rare intensities, or the "
        "number itself.";
    if (state.bars.step > 1.0)
        bins += " The values in this volume are multiples of " + digits(state.bars.step) + "; only these have bars.";
    for (const HistogramBar& fill : state.bars.fill)
        bins += " " + digits(fill.voxels) + " voxels have the fill value " + digits(fill.lower) +
                ", whose bar stands at the end of the axis.";
    hint(bins.c_str());
    point_buttons(model, state, actions);
    ImGui::SameLine();
    const char* help = "How to edit (?)";
    if (ImGui::CalcTextSize(help).x > ImGui::GetContentRegionAvail().x) help = "(?)";
    if (ImGui::CalcTextSize(help).x > ImGui::GetContentRegionAvail().x) ImGui::NewLine();
    ImGui::SetCursorPosX(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(help).x);
    ImGui::TextDisabled("%s", help);
    hint(
        "Left to right: the file's intensities, over how often they occur. Upwards: opacity, as its square root, so "
        "that small opacities can be seen and dragged.\n\n"
        "Drag a point to move it. Double click on empty space adds one, right click on a point deletes it. The wheel "
        "shifts all points; Ctrl + drag does, too. The lines \"paint\" and \"haptic\" are the thresholds; drag them or "
        "their labels, or double-click them for a value that fits the volume.\n\n"
        "With Shift, drags and the wheel go a tenth as far.");
}

/// The whole curve at once.
void unpainted(const Model& model, Actions& actions)
{
    double opacity = model.session.unpainted.opacity;
    const bool is_other = slider("Volume", opacity, 0.0, 1.0, "%.2f opaque");
    if (!resets("unpainted.opacity", actions) && is_other)
        set(actions, model, [&](Session& s) { s.unpainted.opacity = opacity; });
    hint(
        "Opacity of the unpainted volume: multiplies the whole curve. Below 1, painted groups and traces inside show "
        "through.");
}

/// Draws number fields for the point that was selected or moved last.
void edit_point(const Model& model, size_t index, Actions& actions)
{
    const auto before = model.session.transfer_function.points();
    TransferCurve::Points points(before.begin(), before.end());
    ControlPoint& point = points[index];
    const double speed = (model.statistics.range().upper - model.statistics.range().lower) / 500.0;
    const TransferCurve held(model.session.transfer_function);
    const double least = held.held_between_neighbors(index, -DBL_MAX);
    const double most = held.held_between_neighbors(index, DBL_MAX);
    const char* format = is_float(model.volume.type) ? "%.5g" : "%.1f";
    row("Intensity");
    bool changed = drag_number("##intensity", point.intensity, std::max(speed, 1e-6), least, most, format);
    hint(
        "Intensity of the selected point, in the file's units. Drag sideways, with Shift a tenth as fast; or Ctrl + "
        "click to type.");
    row("Opacity");
    changed |= drag_number("##opacity", point.opacity, 0.002, 0.0, 1.0, "%.4f", ImGuiSliderFlags_Logarithmic);
    hint("Opacity of one voxel: 0 clear, 1 solid.");
    row("Colour");
    changed |= color_field("##colour", point.color, true);
    if (changed) send(std::move(points), model, actions);
}

}  // namespace

void transfer_function_panel(const Model& model, Actions& actions)
{
    static CurveState state;
    const TransferFunction& function = model.session.transfer_function;
    const size_t count = function.points().size();
    preset_line(model, actions);
    if (count < 2) {
        ImGui::TextWrapped("There is no transfer function, so nothing is visible.");
        return;
    }
    follow_volume(model, state);
    state.selected = std::min(state.selected, count - 1);
    const size_t edited = state.selected;  // an index into this frame's points
    curve_widget(model, state, actions);
    scale_and_help(model, state, actions);
    edit_point(model, edited, actions);
    unpainted(model, actions);
    if (function.draws_nothing()) ImGui::TextDisabled("Nothing is visible: every opacity is 0.");
}

}  // namespace shvr::ui
