// Cost and exactness of pictures.

#include <algorithm>
#include <string>

#include <imgui/imgui.h>

#include "engine/session/quality.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Steps of pre-integration are at most 1.
constexpr double MAX_PREINTEGRATED_STEP = 1.0;

void choices(const Model& model, Actions& actions)
{
    const std::optional<Quality> present = quality_of(model.session.render);
    row("Quality");
    if (!ImGui::BeginCombo("##quality", present ? present->name : "your own")) {
        hint(present ? present->note : "Settings that match no preset: draft, interactive, good, reference.");
        return;
    }
    for (const Quality& quality : qualities()) {
        if (ImGui::Selectable(quality.name, present && std::string(present->name) == quality.name))
            set(actions, model, [&](Session& s) { take(s.render, quality); });
        hint(quality.note);
    }
    ImGui::EndCombo();
}

bool sampling(RenderSettings& render)
{
    int chosen = int(render.sampling);
    row("Sampling");
    const bool is_other = ImGui::Combo("##sampling", &chosen, "as suits the device\0exact\0by the texture unit\0");
    hint(
        "How voxels are interpolated. Texture units are fast on GPUs and round positions to 1/256 of a voxel. A change "
        "reloads the volume.");
    render.sampling = Sampling(chosen);
    if (render.sampling != Sampling::exact) render.exact_integral = false;
    return is_other;
}

bool gradient(RenderSettings& render)
{
    int chosen = int(render.gradient);
    row("Gradient");
    const bool is_other = ImGui::Combo("##gradient", &chosen, "over one voxel\0inside a voxel\0");
    hint(
        "Differences that give shading its normals. Inside a voxel: half of the reads, but steps show where voxels "
        "meet. "
        "The exact integral always uses those over one voxel.");
    render.gradient = Gradient(chosen);
    return is_other;
}

bool paging(RenderSettings& render)
{
    int chosen = int(render.paging);
    row("Paging");
    const bool is_other = ImGui::Combo("##paging", &chosen, "if needed\0always\0never\0");
    hint(
        "Whether parts of the volume are paged into device memory as they become visible. Never: a volume that does "
        "not fit is refused. A change reloads the volume.");
    render.paging = Paging(chosen);
    return is_other;
}

bool numbers(RenderSettings& render, bool& is_reset, Actions& actions)
{
    bool is_other = slider("Step", render.step_voxels, 0.05, 4.0, "%.3g voxels", ImGuiSliderFlags_Logarithmic);
    hint(
        "Distance between samples along a ray. Half of it takes twice as long. Above 1, narrow peaks cannot be "
        "detected.");
    is_reset |= resets("render.step_voxels", actions);
    if (render.step_voxels > MAX_PREINTEGRATED_STEP) render.preintegration = render.exact_integral = false;
    is_other |= slider("Opaque from", render.opacity_limit, 0.5, 1.0, "%.4f");
    hint("A ray stops once its opacity reaches this; 1: never before its end.");
    is_reset |= resets("render.opacity_limit", actions);
    is_other |= slider("Detail", render.detail, 0.0, 8.0, "%.2g voxels a pixel");
    hint("Multi-resolution volumes only: minimum voxels per pixel. Higher is finer; 0: always the finest level.");
    is_reset |= resets("render.detail", actions);
    return is_other;
}

void budget(const Model& model)
{
    constexpr double MEBIBYTE = 1024.0 * 1024.0;
    ImGui::TextDisabled("GPU memory: %.0f of %.0f MiB", double(model.device_bytes) / MEBIBYTE,
                        double(model.device_budget) / MEBIBYTE);
    hint("Memory in use, and its limit. Set the limit in Preferences (menu Edit), for the next start.");
}

}  // namespace

void quality_panel(const Model& model, Actions& actions)
{
    choices(model, actions);
    RenderSettings render = model.session.render;
    bool is_reset = false;
    bool is_other = numbers(render, is_reset, actions);
    is_other |= sampling(render);
    is_other |= paging(render);
    is_other |= gradient(render);
    is_other |= ImGui::Checkbox("Skip empty space", &render.skip_empty_space);
    hint("Same picture, only faster. Switch it off for measurements only.");
    ImGui::BeginDisabled(render.step_voxels > MAX_PREINTEGRATED_STEP);
    is_other |= ImGui::Checkbox("Narrow peaks", &render.preintegration);
    ImGui::EndDisabled();
    hint("No peak or edge of the transfer function is missed between two samples, however narrow (pre-integration).");
    ImGui::BeginDisabled(render.step_voxels > MAX_PREINTEGRATED_STEP || render.sampling != Sampling::exact);
    is_other |= ImGui::Checkbox("Exact integral", &render.exact_integral);
    ImGui::EndDisabled();
    hint(
        "Integrates light between borders of voxels and points of the transfer function instead of sampling steps: for "
        "pictures to compare with. Needs exact sampling.");
    is_other |= ImGui::Checkbox("Smooth borders of groups", &render.smooth_borders);
    hint(
        "Draws borders of painted groups smoothly instead of in steps. The paint stays as it is, and slices show it. A "
        "picture takes about half as long again where much is painted.");
    if (is_other && !is_reset) set(actions, model, [&](Session& s) { s.render = render; });
    budget(model);
}

}  // namespace shvr::ui
