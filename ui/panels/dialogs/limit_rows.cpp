#include "ui/panels/dialogs/limit_rows.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>

#include <imgui/imgui.h>

#include "engine/base/text.h"
#include "engine/workbench/forms/operation_form.h"
#include "engine/workbench/lists/group_list.h"
#include "ui/panels/color_field.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/number_field.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

enum class Region { everywhere, visible, box };
constexpr const char* REGIONS[] = {"the whole scan", "the visible part (cutting planes)", "a box"};

/// Between frames.
struct LimitsForm {
    bool has_range = false;
    glm::dvec2 range{0.0};
    std::optional<std::filesystem::path> range_of{};  ///< the scan whose intensities `range` has
    std::optional<int64_t> inside{};
    bool only_unpainted = false;
    Region region = Region::everywhere;
    Size3 first{0}, last{0};  ///< the corner voxels of the box, both inside
    Size3 size{0};            ///< the size of the volume that `first` and `last` refer to
    bool awaits_click = false;
};
LimitsForm limits_form;

void swatch(const Groups& groups, uint8_t group)
{
    const float side = ImGui::GetTextLineHeight();
    ImGui::ColorButton("##color", encoded(group_of(groups, group).color),
                       ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop, {side, side});
    ImGui::SameLine();
}

/// Returns whether the group was chosen.
bool group_entry(uint8_t group, bool is_chosen, const Groups& groups)
{
    ImGui::PushID(group);
    if (group > 0) swatch(groups, group);
    const std::string label = label_of_group(groups, group);
    want_glyphs(label);
    const bool is_clicked = ImGui::Selectable(verbatim(label).c_str(), is_chosen);
    ImGui::PopID();
    return is_clicked;
}

/// Puts the box around the probe's ball at a voxel.
void place_box(const glm::dvec3& voxel, const Model& model)
{
    const Size3 size(model.volume.size);
    const glm::dvec3 reach = model.brush().radius_voxels * model.volume.spacing.x / model.volume.spacing;
    limits_form.first = glm::clamp(Size3(glm::floor(voxel - reach)), Size3(0), size - int64_t{1});
    limits_form.last = glm::clamp(Size3(glm::ceil(voxel + reach)) - int64_t{1}, limits_form.first, size - int64_t{1});
    limits_form.size = size;
}

/// Suggests the intensities of this scan that paint reaches.
void suggest_range(const Model& model)
{
    const double low = suggested_intensity(model.paint_threshold(), model.volume.type);
    limits_form.range = {low, std::max(low, std::ceil(model.statistics.maximum))};
    limits_form.range_of = model.session.volume_path;
}

void range_rows(const Model& model)
{
    if (limits_form.range_of != model.session.volume_path) {
        limits_form.has_range = false;
        suggest_range(model);
    }
    const float width = 5.0f * ImGui::GetFontSize();
    field_name("");
    ImGui::Checkbox("Only some intensities", &limits_form.has_range);
    hint("Changes only voxels whose intensities, in the scan's own values, lie in a range");
    if (!limits_form.has_range) return;
    field_name("Intensities from");
    ImGui::SetNextItemWidth(width);
    number_field("##low", limits_form.range.x);
    hint("The lowest intensity of voxels that change");
    ImGui::SameLine();
    ImGui::TextUnformatted("to");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(width);
    number_field("##high", limits_form.range.y);
    hint("The highest intensity of voxels that change");
}

void box_rows(const Model& model)
{
    field_name("First voxel");
    whole_fields("##first", {&limits_form.first.x, 3});
    hint("Corner of the box: x, y and z in voxels, counted from 0");
    field_name("Last voxel");
    whole_fields("##last", {&limits_form.last.x, 3});
    hint("The opposite corner, which is in the box, too");
    field_name("");
    if (ImGui::Button("Around the probe")) place_box(model.probe_voxel, model);
    hint("The box around the probe's ball, where the probe is now");
    button_beside_or_below("Around a click");
    if (ImGui::Button("Around a click")) limits_form.awaits_click = true;
    hint("The box around the probe's ball, where you click in the picture or in a slice next");
    if (!limits_form.awaits_click) return;
    constexpr const char* WHAT_TO_DO = "click in the picture";
    beside_or_below(ImGui::CalcTextSize(WHAT_TO_DO).x);
    ImGui::TextDisabled("%s", WHAT_TO_DO);
}

void region_rows(const Model& model, const std::optional<glm::dvec3>& clicked)
{
    field_name("Where");
    if (ImGui::BeginCombo("##where", REGIONS[size_t(limits_form.region)])) {
        for (size_t i = 0; i < std::size(REGIONS); ++i) {
            const bool is_chosen = limits_form.region == Region(i);
            if (!ImGui::Selectable(REGIONS[i], is_chosen) || is_chosen) continue;
            limits_form.region = Region(i);
            if (limits_form.region == Region::box) place_box(model.probe_voxel, model);
        }
        ImGui::EndCombo();
    }
    hint("Voxels elsewhere do not change");
    const CutBox& cut = model.session.cut;
    const bool hides = cut.plane_normal || glm::any(glm::greaterThan(cut.lower, glm::dvec3(0.0))) ||
                       glm::any(glm::lessThan(cut.upper, glm::dvec3(model.volume.size)));
    if (limits_form.region == Region::everywhere && hides) {
        field_name("");
        ImGui::PushTextWrapPos(0.0f);
        ImGui::TextDisabled("Voxels behind cutting planes change, too.");
        ImGui::PopTextWrapPos();
    }
    if (limits_form.region != Region::box) return;
    if (clicked && std::exchange(limits_form.awaits_click, false)) place_box(*clicked, model);
    box_rows(model);
}

VoxelBox visible_box(const Model& model)
{
    const CutBox& cut = model.session.cut;
    return {glm::max(Size3(glm::floor(cut.lower)), Size3(0)),
            glm::min(Size3(glm::ceil(cut.upper)), Size3(model.volume.size))};
}

/// Returns the box that the rows state, and why there is none, if there should be one.
std::pair<std::optional<VoxelBox>, std::string> stated_box(const Model& model)
{
    if (limits_form.region == Region::everywhere) return {};
    if (limits_form.region == Region::visible) return {visible_box(model), ""};
    const Size3 size(model.volume.size);
    const bool is_in = glm::all(glm::greaterThanEqual(limits_form.first, Size3(0))) &&
                       glm::all(glm::lessThanEqual(limits_form.first, limits_form.last)) &&
                       glm::all(glm::lessThan(limits_form.last, size));
    if (is_in) return {VoxelBox{limits_form.first, limits_form.last + int64_t{1}}, ""};
    return {std::nullopt,
            sentence("the box goes from voxel ", digits_of(limits_form.first), " to ", digits_of(limits_form.last),
                     "; expected a first voxel from 0 0 0 and a last one, at least as large, up to ",
                     digits_of(size - int64_t{1}))};
}

void locks_row(const Model& model)
{
    std::string locked;
    for (const auto& [group, settings] : model.session.groups)
        if (settings.locked) locked += (locked.empty() ? "" : ", ") + label_of_group(model.session.groups, group);
    if (locked.empty()) return;
    field_name("Locked");
    want_glyphs(locked);
    ImGui::TextWrapped("%s", locked.c_str());
    hint("Voxels of locked groups do not change, and locked groups gain none");
}

}  // namespace

void group_row(const char* name, std::optional<int64_t>& group, const Model& model, const char* none,
               bool has_unpainted)
{
    const Groups& groups = model.session.groups;
    ImGui::PushID(name);
    field_name(name);
    if (group && *group > 0) swatch(groups, uint8_t(*group));
    ImGui::SetNextItemWidth(width_of_value(16.0f));
    const std::string shown = group ? label_of_group(groups, uint8_t(*group)) : none;
    want_glyphs(shown);
    if (ImGui::BeginCombo("##group", verbatim(shown).c_str(), ImGuiComboFlags_HeightLarge)) {
        if (none && ImGui::Selectable(none, !group)) group.reset();
        if (has_unpainted && group_entry(0, group == 0, groups)) group = 0;
        const auto chosen = uint8_t(group.value_or(0));
        for (const GroupRow& row : listed_groups(groups, model.voxels_by_group, {}, chosen))
            if (row.group > 0 && group_entry(row.group, group == row.group, groups)) group = row.group;
        ImGui::EndCombo();
    }
    ImGui::PopID();
}

void group_row(const char* name, int64_t& group, const Model& model, bool has_unpainted)
{
    std::optional<int64_t> chosen = group;
    group_row(name, chosen, model, nullptr, has_unpainted);
    group = chosen.value_or(group);
}

std::string limit_rows(OperationLimits& limits, const Model& model, const std::optional<glm::dvec3>& clicked,
                       bool limits_intensities)
{
    if (limits_form.size != Size3(model.volume.size)) place_box(model.probe_voxel, model);
    ImGui::Separator();
    region_rows(model, clicked);
    group_row("Only in", limits_form.inside, model, "any group", true);
    hint("Changes only voxels that have this group now");
    if (limits_intensities) range_rows(model);
    const bool has_range = limits_intensities && limits_form.has_range;
    field_name("");
    ImGui::Checkbox("Only unpainted voxels", &limits_form.only_unpainted);
    hint("No group loses voxels");
    locks_row(model);
    ImGui::Separator();
    auto [box, why] = stated_box(model);
    limits = {.within = has_range ? std::optional(limits_form.range) : std::nullopt,
              .inside = limits_form.inside,
              .only_unpainted = limits_form.only_unpainted,
              .box = box};
    const CutBox& cut = model.session.cut;
    if (limits_form.region == Region::visible && cut.plane_normal) {
        limits.plane_normal = cut.plane_normal;
        limits.plane_point = cut.plane_point.value_or(0.5 * glm::dvec3(model.volume.size));
    }
    if (has_range && !(limits_form.range.x <= limits_form.range.y))
        return sentence("the intensities go from ", plain_digits_of(limits_form.range.x), " to ",
                        plain_digits_of(limits_form.range.y), "; expected the lower one first");
    return why;
}

bool limit_rows_take_clicks()
{
    return limits_form.region == Region::box && limits_form.awaits_click;
}

}  // namespace shvr::ui
