// Local ambient occlusion: how much of the ambient light reaches a place.

#include <imgui/imgui.h>

#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

void occlusion_panel(const Model& model, Actions& actions)
{
    OcclusionSettings settings = model.session.light.occlusion;
    bool is_other = slider("Strength", settings.strength, 0.0, 1.0, "%.2f");
    hint("How dark it gets where less ambient light arrives: in gaps, and where things touch. 0 switches it off.");
    is_other |=
        slider("Radius", settings.radius, 1.0, MOST_OCCLUSION_RADIUS, "%.0f voxels", ImGuiSliderFlags_Logarithmic);
    hint("How far away things keep light off.");
    is_other |= slider("Curve", settings.curve, 0.25, 4.0, "%.2f", ImGuiSliderFlags_Logarithmic);
    hint("Exponent of the light that arrives: above 1, what is half dark gets darker.");
    const uint32_t fewest = 4, most = 256;
    ImGui::SetNextItemWidth(-8.0f * ImGui::GetFontSize());
    is_other |= ImGui::SliderScalar("Rays", ImGuiDataType_U32, &settings.rays, &fewest, &most, "%u",
                                    ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
    hint("Directions that light is looked for in, for each voxel: more are finer and take longer.");
    is_other |= ImGui::Checkbox("Full sphere", &settings.full_sphere);
    hint("Looks behind surfaces, too. Otherwise only before them.");
    ImGui::SameLine();
    is_other |= ImGui::Checkbox("Automatic", &settings.automatic);
    hint("Renews it at every change. Otherwise when asked to: F8.");
    if (is_other) actions.push_back(SetOcclusion{settings});
    if (settings.automatic || settings.strength == 0.0) return;
    ImGui::SameLine();
    if (ImGui::Button("Update")) actions.push_back(UpdateOcclusion{});
}

}  // namespace shvr::ui
