// Background, light and distance blending.

#include "ui/panels/panels.h"

#include <algorithm>
#include <cmath>

#include <imgui/imgui.h>

#include "engine/workbench/curves/light_ball.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/color_field.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

bool explained_slider(const char* label, double& value, double maximum, const char* help, ImGuiSliderFlags flags = 0)
{
    const bool changed = slider(label, value, 0.0, maximum, "%.2f", flags);
    hint(help);
    return changed;
}

void background(const Model& model, Actions& actions)
{
    glm::dvec3 color(model.session.render.background);
    label("Background");
    if (color_field("##background", color))
        set(actions, model, [&](Session& s) { s.render.background = glm::dvec4(color, s.render.background.a); });
    hint("Colour behind everything. Dark behind thin, bright structures shows more of them.");
    const auto shortcut = [&](const char* name, double value) {
        ImGui::SameLine();
        if (ImGui::SmallButton(name))
            set(actions, model,
                [&](Session& s) { s.render.background = glm::dvec4(glm::dvec3(value), s.render.background.a); });
    };
    shortcut("White", 1.0);
    shortcut("Grey", 0.2);
    shortcut("Black", 0.0);
}

/// Draws a ball whose highlight shows the light's direction; dragging moves the light. Returns whether it was dragged.
bool light_ball(glm::dvec3& direction, bool& is_reset, Actions& actions)
{
    const float side = 5.0f * ImGui::GetFontSize(), radius = 0.46f * side;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 middle{corner.x + 0.5f * side, corner.y + 0.5f * side};
    ImGui::InvisibleButton("light ball", {side, side});
    const bool is_dragged = ImGui::IsItemActive();
    hint_beside("Drag the light over the ball: the volume is lit as this ball is, from the viewer's side.");
    is_reset |= resets("light.direction", actions);
    if (is_dragged) {
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        direction = direction_at({(mouse.x - middle.x) / radius, (middle.y - mouse.y) / radius});
    }
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const glm::dvec2 place = place_on_ball(light_direction(direction));
    list.AddCircleFilled(middle, radius, IM_COL32(62, 62, 62, 255), 40);
    // Draws ever smaller and brighter discs, shifted towards the light, which look like a shaded ball.
    constexpr int RINGS = 14;
    for (int ring = 1; ring <= RINGS; ++ring) {
        const float share = float(ring) / float(RINGS + 1);
        const ImVec2 at{middle.x + share * radius * float(place.x), middle.y - share * radius * float(place.y)};
        const int level = 62 + int(165.0f * share);
        list.AddCircleFilled(at, radius * (1.0f - share), IM_COL32(level, level, level, 255), 32);
    }
    const ImVec2 light{middle.x + radius * float(place.x), middle.y - radius * float(place.y)};
    list.AddCircleFilled(light, 0.28f * ImGui::GetFontSize(), IM_COL32(255, 236, 150, 255));
    list.AddCircle(light, 0.28f * ImGui::GetFontSize(), IM_COL32(30, 30, 30, 255), 0, 1.5f);
    return is_dragged;
}

bool light_angle(const char* name, double& degrees, double most, const char* help)
{
    ImGui::SetNextItemWidth(6.0f * ImGui::GetFontSize());
    const bool is_other = drag_number(name, degrees, 1.0, -most, most, "%.0f\u00b0");
    hint(help);
    return is_other;
}

bool light_from(Light& light, bool& is_reset, Actions& actions)
{
    glm::dvec3 direction = light_direction(light.direction);
    bool is_other = light_ball(direction, is_reset, actions);
    ImGui::SameLine();
    ImGui::BeginGroup();
    ImGui::TextUnformatted("Light from");
    LightAngles angles = angles_of(direction);
    if (light_angle("right", angles.right_degrees, 180.0, "To the right of you; below 0 to the left. Drag sideways.") |
        light_angle("above", angles.up_degrees, 90.0, "Above you; below 0 from below. Drag sideways.")) {
        direction = direction_of(angles);
        is_other = true;
    }
    if (is_other) light.direction = direction;
    ImGui::BeginDisabled(light.direction == glm::dvec3(0.0));
    if (ImGui::SmallButton("Over the shoulder")) {
        light.direction = glm::dvec3(0.0);
        is_other = true;
    }
    ImGui::EndDisabled();
    hint("The usual light: from above and a little to the right.");
    ImGui::EndGroup();
    return is_other;
}

void light_controls(const Model& model, Actions& actions)
{
    Light light = model.session.light;
    bool changed = ImGui::Checkbox("Shading", &light.shaded);
    hint("Light from over your shoulder. Without it, colours are as chosen in the transfer function.");
    bool is_reset = false;
    changed |= light_from(light, is_reset, actions);
    changed |= explained_slider("Ambient", light.ambient, 1.0, "Share of a colour that does not depend on the light.");
    is_reset |= resets("light.ambient", actions);
    changed |= explained_slider("Diffuse", light.diffuse, 1.0, "Share that depends on which way a surface faces.");
    is_reset |= resets("light.diffuse", actions);
    changed |= explained_slider("Highlight", light.specular, 1.0, "Strength of the highlight.");
    is_reset |= resets("light.specular", actions);
    changed |= explained_slider("Shininess", light.shininess, 256.0, "How small and sharp the highlight is.",
                                ImGuiSliderFlags_Logarithmic);
    is_reset |= resets("light.shininess", actions);
    changed |= slider("Fade below", light.gradient_fade, 0.0, 0.2, "%.3f", ImGuiSliderFlags_Logarithmic);
    is_reset |= resets("light.gradient_fade", actions);
    hint(
        "Steepness, as a share of the intensities per voxel, below which there is no surface to be lit: noise in flat "
        "places gets no shading.");
    if (changed && !is_reset) set(actions, model, [&](Session& s) { s.light = light; });
}

void blend_controls(const Model& model, Actions& actions)
{
    DistanceBlend blend = model.session.blend;
    bool changed =
        explained_slider("Blend size", blend.size, 1.0,
                         "Distance blending: share of another colour at the far end of the volume. 0 is off, 1 is all. "
                         "Keys: menu View, Distance blending.");
    bool is_reset = resets("blend.size", actions);
    changed |= explained_slider(
        "Blend rate", blend.rate, 10.0,
        "How it grows with depth: 0 the same everywhere, 1 evenly, above 1 near things stay clear. Keys: menu "
        "View, Distance blending.");
    is_reset |= resets("blend.rate", actions);
    glm::dvec3 color = blend.color.value_or(glm::dvec3(model.session.render.background));
    label("Blend colour");
    if (color_field("##blend colour", color)) {
        blend.color = color;
        changed = true;
    }
    hint("The background colour unless you choose another.");
    if (blend.color) {
        ImGui::SameLine();
        if (ImGui::SmallButton("Background's")) {
            blend.color.reset();
            changed = true;
        }
    }
    if (changed && !is_reset) set(actions, model, [&](Session& s) { s.blend = blend; });
}

}  // namespace

void light_panel(const Model& model, Actions& actions)
{
    ImGui::PushItemWidth(-7.0f * ImGui::GetFontSize());
    background(model, actions);
    ImGui::Separator();
    light_controls(model, actions);
    ImGui::Separator();
    blend_controls(model, actions);
    ImGui::PopItemWidth();
}

}  // namespace shvr::ui
