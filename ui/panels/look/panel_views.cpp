// The window's panes and their settings.

#include <algorithm>
#include <cmath>

#include <imgui/imgui.h>

#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

bool choice(const char* label, int& chosen, const char* names)
{
    row(label);
    return ImGui::Combo(sentence("##", label).c_str(), &chosen, names);
}

bool stereo_controls(StereoSettings& stereo, bool& is_reset, Actions& actions)
{
    int output = int(stereo.output);
    bool is_other = choice("Shown", output, "side by side\0one above the other\0red and cyan glasses\0");
    hint("How the two eyes' pictures reach your screen or glasses.");
    stereo.output = StereoOutput(output);
    is_other |= slider("Eyes apart", stereo.eye_distance, 0.0, 0.2, "%.3f");
    hint(
        "Relative to the distance from the camera to its pivot. Less is easier on the "
        "eyes.");
    is_reset |= resets("view.stereo.eye_distance", actions);
    is_other |= ImGui::Checkbox("Toe-in", &stereo.toe_in);
    hint("Turns the eyes towards each other. Otherwise both look straight ahead, which strains less.");
    return is_other;
}

/// Draws sliders for the slices, one per axis, in voxels from 0. They move the cross-hairs, and the probe to these.
void slice_sliders(const Model& model, Actions& actions)
{
    const glm::dvec3 cross = cross_of(model.session.view.slices, model.probe_voxel);
    for (int axis = 2; axis >= 0; --axis) {
        const double last = double(model.volume.size[axis]) - 1.0;
        double slice = std::clamp(std::floor(cross[axis]), 0.0, last);
        const char* const names[] = {"Slice x", "Slice y", "Slice z"};
        if (!slider(names[axis], slice, 0.0, last, "%.0f")) continue;
        glm::dvec3 voxel = cross;
        voxel[axis] = std::floor(slice + 0.5) + 0.5;
        actions.push_back(PlaceProbe{voxel});
    }
}

bool slice_controls(SliceSettings& slices, const Model& model, bool& is_reset, Actions& actions)
{
    slice_sliders(model, actions);
    const auto [lower, upper] = model.statistics.range();
    double black = slices.black.value_or(lower), white = slices.white.value_or(upper);
    const double step = 1e-6 * (upper - lower);
    bool is_other = false;
    if (slider("Black", black, lower, upper, "%.5g")) {
        slices.black = std::min(black, white - step);
        is_other = true;
    }
    hint("Intensities up to here are black.");
    is_reset |= resets("view.slices.black", actions);
    if (slider("White", white, lower, upper, "%.5g")) {
        slices.white = std::max(white, black + step);
        is_other = true;
    }
    hint("Intensities from here on are white.");
    is_reset |= resets("view.slices.white", actions);
    if (ImGui::Button("Automatic contrast")) actions.push_back(AutoContrast{});
    hint(("Black and white so that almost all voxels lie between them" +
          key_in_brackets("auto_contrast", model.keymap) + ". In a slice: Ctrl + drag.")
             .c_str());
    is_other |= slider("Paint", slices.paint_share, 0.0, 1.0, "%.2f");
    hint("How strongly painted voxels take their group's colour.");
    is_reset |= resets("view.slices.paint_share", actions);
    is_other |= slider("Enlarged", slices.zoom, 1.0, 50.0, "%.1f times", ImGuiSliderFlags_Logarithmic);
    hint("Magnification of the slices. In a slice: Ctrl + wheel; Shift + drag moves them.");
    is_reset |= resets("view.slices.zoom", actions);
    return is_other;
}

void interaction_controls(const Model& model, Actions& actions)
{
    InteractionSettings interaction = model.session.interaction;
    double percent = 100.0 * interaction.resolution;
    bool is_other = slider("In motion", percent, 10.0, 100.0, "%.0f %%");
    hint("Resolution during motion. A still picture is always sharp.");
    bool is_reset = resets("interaction.resolution", actions);
    interaction.resolution = percent / 100.0;
    is_other |= slider("Frames", interaction.frames_per_second, 5.0, 120.0, "at most %.0f a second");
    hint("Higher is smoother and leaves less time for other work.");
    is_reset |= resets("interaction.frames_per_second", actions);
    int scale = int(interaction.screenshot_scale);
    const int smallest = 1, largest = 16;
    row("Screenshot");
    is_other |= slider_scalar("##screenshot", ImGuiDataType_S32, &scale, &smallest, &largest, "%d times");
    hint(("Size of large screenshots" + key_in_brackets("large_screenshot", model.keymap) + ", relative to the window.")
             .c_str());
    is_reset |= resets("interaction.screenshot_scale", actions);
    interaction.screenshot_scale = uint32_t(scale);
    if (is_other && !is_reset) set(actions, model, [&](Session& s) { s.interaction = interaction; });
}

}  // namespace

void views_panel(const Model& model, Actions& actions)
{
    ViewSettings view = model.session.view;
    int arrangement = int(view.arrangement);
    bool is_other = choice("Window", arrangement, "single view\0two eyes\0overview\0slices\0");
    hint("One view, two eyes, an overview with maps of where the camera is, or slices through the probe (menu View).");
    view.arrangement = Arrangement(arrangement);
    bool is_reset = false;
    switch (view.arrangement) {
        case Arrangement::single: break;
        case Arrangement::stereo: is_other |= stereo_controls(view.stereo, is_reset, actions); break;
        case Arrangement::overview:
            is_other |= slider("Map scale", view.overview_zoom, 0.1, 10.0, "%.2f", ImGuiSliderFlags_Logarithmic);
            hint("Below 1 the maps show more of the surroundings.");
            is_reset |= resets("view.overview_zoom", actions);
            break;
        case Arrangement::slices: is_other |= slice_controls(view.slices, model, is_reset, actions); break;
    }
    if (is_other && !is_reset) set(actions, model, [&](Session& s) { s.view = view; });
    ImGui::Separator();
    interaction_controls(model, actions);
}

}  // namespace shvr::ui
