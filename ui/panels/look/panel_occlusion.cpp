// Local ambient occlusion: how much of the ambient light reaches a point, and the curve from that share to brightness.

#include <algorithm>

#include <imgui/imgui.h>

#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/curves/fine_drag.h"
#include "engine/workbench/curves/occlusion_curve.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// The selected point, whose values are shown as numbers, and whether the mouse is dragging that point.
size_t chosen_point = 0;
bool drags_point = false;
FineDrag held_point;

void send(OcclusionPoints points, const Model& model, Actions& actions)
{
    set(actions, model, [&](Session& s) { s.light.occlusion.mapping = std::move(points); });
}

void draw_curve(const OcclusionSettings& settings, const ImVec2& begin, const ImVec2& end)
{
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const auto at = [&](double x, double y) {
        return ImVec2(begin.x + float(x) * (end.x - begin.x), end.y - float(y) * (end.y - begin.y));
    };
    list.AddRectFilled(begin, end, ImGui::GetColorU32(ImGuiCol_FrameBg));
    for (const double share : {0.25, 0.5, 0.75}) {
        list.AddLine(at(share, 0.0), at(share, 1.0), ImGui::GetColorU32(ImGuiCol_Border));
        list.AddLine(at(0.0, share), at(1.0, share), ImGui::GetColorU32(ImGuiCol_Border));
    }
    constexpr int STEPS = 128;
    const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
    for (int i = 0; i < STEPS; ++i) {
        const double from = double(i) / STEPS, to = double(i + 1) / STEPS;
        list.AddLine(at(from, seen_of(settings, from)), at(to, seen_of(settings, to)), ink, 1.5f);
    }
    const float radius = 0.3f * ImGui::GetFontSize();
    for (size_t i = 0; i < settings.mapping.size(); ++i) {
        const ImVec2 place = at(settings.mapping[i].arrives, settings.mapping[i].seen);
        list.AddCircleFilled(place, radius, ImGui::GetColorU32(ImGuiCol_WindowBg));
        list.AddCircle(place, radius, ink, 0, i == chosen_point ? 3.0f : 1.5f);
    }
}

/// Draws the curve in a square: a double click adds a point, a drag moves one, and a right click removes one.
void curve_field(const OcclusionSettings& settings, const Model& model, Actions& actions)
{
    label("");
    const ImVec2 begin = ImGui::GetCursorScreenPos();
    const ImVec2 size{std::max(ImGui::GetContentRegionAvail().x, 40.0f), 6.0f * ImGui::GetFontSize()};
    const ImVec2 end{begin.x + size.x, begin.y + size.y};
    ImGui::InvisibleButton("curve", size, ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    hint_beside(
        "From the light that arrives (left to right) to the light that is seen (upwards): darker where the curve is "
        "below the diagonal. Double click: a point; drag: moves it, with Shift a tenth as far; right click: removes "
        "it.");
    const ImVec2 mouse = ImGui::GetMousePos();
    const auto place_of = [&](const glm::vec2& at) {
        return glm::dvec2((at.x - begin.x) / size.x, (end.y - at.y) / size.y);
    };
    const glm::dvec2 place = place_of({mouse.x, mouse.y});
    const double reach = 0.7 * double(ImGui::GetFontSize());
    const std::optional<size_t> under =
        point_under(settings.mapping, place, {reach / double(size.x), reach / double(size.y)});
    OcclusionPoints points = settings.mapping;
    if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0) && !under) {
        if (points.empty()) points = points_of_power(settings.curve);
        chosen_point = add(points, {place.x, place.y});
        drags_point = true;
        held_point = FineDrag({mouse.x, mouse.y}, {mouse.x, mouse.y});
        send(std::move(points), model, actions);
    } else if (ImGui::IsItemClicked(0)) {
        drags_point = under.has_value();
        held_point = FineDrag({mouse.x, mouse.y}, {mouse.x, mouse.y});
        if (under) chosen_point = *under;
    } else if (ImGui::IsItemClicked(1) && under) {
        send(without(std::move(points), *under), model, actions);
    } else if (drags_point && ImGui::IsItemActive() && ImGui::IsMouseDragging(0, 0.0f) &&
               chosen_point < points.size()) {
        const glm::dvec2 to = place_of(held_point.follow({mouse.x, mouse.y}, ImGui::GetIO().KeyShift));
        send(moved(std::move(points), chosen_point, {to.x, to.y}), model, actions);
    }
    if (!ImGui::IsMouseDown(0)) drags_point = false;
    draw_curve(settings, begin, end);
}

/// Draws number fields for the curve, for use without a mouse.
void curve_numbers(const OcclusionSettings& settings, const Model& model, Actions& actions)
{
    const OcclusionPoints& points = settings.mapping;
    chosen_point = std::min(chosen_point, points.size() - 1);
    row("Point");
    int number = int(chosen_point) + 1;
    const int first = 1, last = int(points.size());
    if (slider_scalar("##point", ImGuiDataType_S32, &number, &first, &last, "%d"))
        chosen_point = size_t(std::clamp(number, first, last)) - 1;
    hint("Selected curve point.");
    OcclusionPoint point = points[chosen_point];
    bool is_other = slider("Arrives", point.arrives, 0.0, 1.0, "%.2f");
    hint("Share of the light that arrives.");
    is_other |= slider("Seen", point.seen, 0.0, 1.0, "%.2f");
    hint("Share of the light that is shown.");
    if (is_other) send(moved(points, chosen_point, point), model, actions);
    label("");
    ImGui::BeginDisabled(points.size() == MAX_OCCLUSION_POINTS);
    if (ImGui::Button("Add a point")) {
        OcclusionPoints more = points;
        chosen_point = add(more, in_widest_gap(points));
        send(std::move(more), model, actions);
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(points.size() <= 2);
    if (ImGui::Button("Remove it")) send(without(points, chosen_point), model, actions);
    ImGui::EndDisabled();
    label("");
    if (ImGui::Button("Back to a power")) send({}, model, actions);
    hint("Returns to a power curve and discards the points. Undo restores them.");
}

void curve_rows(const OcclusionSettings& settings, const Model& model, Actions& actions)
{
    if (settings.mapping.empty()) {
        double power = settings.curve;
        const bool is_other = slider("Curve", power, 0.25, 4.0, "%.2f", ImGuiSliderFlags_Logarithmic);
        hint("Power of the light that arrives: above 1, half-dark places get darker.");
        if (!resets("light.occlusion.curve", actions) && is_other)
            set(actions, model, [&](Session& s) { s.light.occlusion.curve = power; });
    } else {
        text_label("Curve");
        ImGui::TextUnformatted("of points");
    }
    curve_field(settings, model, actions);
    if (!settings.mapping.empty()) return curve_numbers(settings, model, actions);
    label("");
    if (ImGui::Button("As points")) send(points_of_power(settings.curve), model, actions);
    hint("Switches to a curve with points, for example to increase the contrast.");
}

}  // namespace

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
    if (!settings.automatic && settings.strength != 0.0) {
        ImGui::SameLine();
        if (ImGui::Button("Update")) actions.push_back(UpdateOcclusion{});
    }
    curve_rows(model.session.light.occlusion, model, actions);
}

}  // namespace shvr::ui
