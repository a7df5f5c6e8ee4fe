// Local ambient occlusion: how much of the ambient light reaches a place.

#include <imgui/imgui.h>

#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"
#include "ui/workbench/appearance/hints.h"
#include "ui/workbench/edit.h"

namespace shvr::ui {

void occlusion_panel(const Model& model, Actions& actions)
{
    OcclusionSettings settings = model.session.light.occlusion;
    bool is_reset = false;
    bool is_other = slider("Strength", settings.strength, 0.0, 1.0, "%.2f");
    hint("How dark gaps and contacts get, where little ambient light arrives. 0 switches it off.");
    is_reset |= resets("light.occlusion.strength", actions);
    is_other |=
        slider("Radius", settings.radius, 1.0, MAX_OCCLUSION_RADIUS, "%.0f voxels", ImGuiSliderFlags_Logarithmic);
    hint("How far away an object may be and still block light.");
    is_reset |= resets("light.occlusion.radius", actions);
    is_other |= slider("Curve", settings.curve, 0.25, 4.0, "%.2f", ImGuiSliderFlags_Logarithmic);
    hint("Exponent of the light that arrives: above 1, half-dark places get darker.");
    is_reset |= resets("light.occlusion.curve", actions);
    const uint32_t fewest = 4, most = 256;
    row("Rays");
    is_other |=
        slider_scalar("##rays", ImGuiDataType_U32, &settings.rays, &fewest, &most, "%u", ImGuiSliderFlags_Logarithmic);
    hint("Directions tested for each voxel: more are smoother and take longer.");
    is_reset |= resets("light.occlusion.rays", actions);
    is_other |= ImGui::Checkbox("Full sphere", &settings.full_sphere);
    hint("Also counts light from behind surfaces, not only from the front.");
    ImGui::SameLine();
    is_other |= ImGui::Checkbox("Automatic", &settings.automatic);
    hint(sentence("Updates at every change; otherwise with Update", key_in_brackets("update_occlusion", model.keymap),
                  ".")
             .c_str());
    if (is_other && !is_reset) set(actions, model, [&](Session& s) { s.light.occlusion = settings; });
    if (settings.automatic || settings.strength == 0.0) return;
    ImGui::SameLine();
    if (ImGui::Button("Update")) actions.push_back(UpdateOcclusion{});
}

}  // namespace shvr::ui
