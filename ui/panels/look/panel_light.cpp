#include "ui/panels/panels.h"

#include <algorithm>
#include <cfloat>

#include <imgui/imgui.h>

#include "engine/base/image.h"
#include "ui/panels/widgets.h"
#include "ui/workbench/edit.h"

namespace shvr::ui {

namespace {

bool explained_slider(const char* label, double& value, double maximum, const char* help, ImGuiSliderFlags flags = 0)
{
    const bool changed = slider(label, value, 0.0, maximum, "%.2f", flags);
    hint(help);
    return changed;
}

void light_controls(const Model& model, Actions& actions)
{
    Light light = model.session.light;
    bool changed = ImGui::Checkbox("Shading", &light.shaded);
    hint("Light from over your shoulder. Without it, colours are as chosen in the transfer function.");
    changed |= explained_slider("Ambient", light.ambient, 1.0, "Share of a colour that does not depend on the light.");
    changed |= explained_slider("Diffuse", light.diffuse, 1.0, "Share that depends on which way a surface faces.");
    changed |= explained_slider("Highlight", light.specular, 1.0, "Strength of the highlight.");
    changed |= explained_slider("Shininess", light.shininess, 256.0, "How small and sharp the highlight is.",
                                ImGuiSliderFlags_Logarithmic);
    if (changed) set(actions, model, [&](Session& s) { s.light = light; });
}

void blend_controls(const Model& model, Actions& actions)
{
    DistanceBlend blend = model.session.blend;
    bool changed = explained_slider(
        "Blend size", blend.size, 2.0,
        "Distance blending: how much of another colour there is at the far end of the volume. 0 is off. "
        "Keys: menu View, Distance blending.");
    changed |= explained_slider(
        "Blend rate", blend.rate, 10.0,
        "How it grows with depth: 0 the same everywhere, 1 evenly, above 1 near things stay clear. Keys: menu "
        "View, Distance blending.");
    const glm::dvec3 color = blend.color.value_or(glm::dvec3(model.session.render.background));
    float shown[3];
    for (int i = 0; i < 3; ++i) shown[i] = float(srgb_encode(std::clamp(color[i], 0.0, 1.0)));
    if (ImGui::ColorEdit3("Blend colour", shown, ImGuiColorEditFlags_NoInputs)) {
        glm::dvec3 chosen;
        for (int i = 0; i < 3; ++i) chosen[i] = std::clamp(srgb_decode(double(shown[i])), 0.0, 1.0);
        blend.color = chosen;
        changed = true;
    }
    hint("The background's unless you choose another. Right click resets it.");
    if (blend.color && ImGui::IsItemClicked(ImGuiMouseButton_Right)) {
        blend.color.reset();
        changed = true;
    }
    if (changed) set(actions, model, [&](Session& s) { s.blend = blend; });
}

}  // namespace

void light_panel(const Model& model, Actions& actions)
{
    ImGui::PushItemWidth(-7.0f * ImGui::GetFontSize());
    light_controls(model, actions);
    ImGui::Separator();
    blend_controls(model, actions);
    ImGui::PopItemWidth();
}

}  // namespace shvr::ui
