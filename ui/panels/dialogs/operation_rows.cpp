#include "ui/panels/dialogs/operation_rows.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/text.h"
#include "engine/workbench/forms/volume_units.h"
#include "engine/workbench/lists/group_list.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/dialogs/limit_rows.h"
#include "ui/panels/number_field.h"
#include "ui/panels/tools/outline_tool.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Null: the text is no list of groups.
std::optional<std::vector<uint8_t>> groups_in(std::string text)
{
    std::ranges::replace(text, ',', ' ');
    std::vector<uint8_t> groups;
    for (size_t begin = text.find_first_not_of(' '); begin != std::string::npos;) {
        const size_t end = std::min(text.find(' ', begin), text.size());
        const std::optional<int64_t> number = whole_of(text.substr(begin, end - begin));
        if (!number || *number < 1 || *number > 255) return std::nullopt;
        const auto group = uint8_t(*number);
        if (std::ranges::find(groups, group) == groups.end()) groups.push_back(group);
        begin = text.find_first_not_of(' ', end);
    }
    return groups;
}

/// Between frames, what is typed for parts that are not chosen now.
struct IslandsForm {
    int64_t voxels = 100;
    double mm3 = 1.0;
    bool is_in_mm3 = false;
    std::optional<glm::dvec3> at{};
    std::filesystem::path volume{};  ///< the scan in which `at` was clicked
};
IslandsForm islands_form;

constexpr std::pair<IslandsOp::Keep, const char*> KEPT[] = {{IslandsOp::Keep::largest, "the largest part"},
                                                            {IslandsOp::Keep::at_least, "parts of a size or larger"},
                                                            {IslandsOp::Keep::at, "the part that is clicked"},
                                                            {IslandsOp::Keep::all, "all parts, each its own group"}};

/// Draws a name such as "Distance in mm", shortened where a file's unit is long.
void name_with_unit(const char* name, const std::string& unit)
{
    field_name(shortened(sentence(name, " in ", unit), 8.9f * ImGui::GetFontSize()).c_str());
}

std::string side_in_words(const VolumeInfo& volume)
{
    const std::string unit = volume.unit == "voxel" ? "" : ' ' + unit_of_lengths(volume);
    return sentence("A voxel is ", digits_of(volume.spacing), unit, " long in x, y and z.");
}

void fewest_row(IslandsOp& op, const Model& model)
{
    IslandsForm& form = islands_form;
    const bool is_in_mm3 = form.is_in_mm3 && has_cubic_millimetres(model.volume);
    field_name("Smallest part");
    ImGui::SetNextItemWidth(width_of_value(8.0f));
    if (is_in_mm3)
        number_field("##mm3", form.mm3);
    else
        whole_field("##voxels", form.voxels);
    hint("Parts of exactly this size stay");
    const float voxels_width = ImGui::CalcTextSize("voxels").x;
    if (has_cubic_millimetres(model.volume)) {
        const float circle = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x;
        const float spacing = ImGui::GetStyle().ItemSpacing.x;
        beside_or_below(2.0f * circle + spacing + voxels_width + ImGui::CalcTextSize("mm\u00b3").x);
        if (ImGui::RadioButton("voxels", !is_in_mm3)) form.is_in_mm3 = false;
        ImGui::SameLine();
        if (ImGui::RadioButton("mm\u00b3", is_in_mm3)) form.is_in_mm3 = true;
    } else {
        beside_or_below(voxels_width);
        ImGui::TextUnformatted("voxels");
    }
    form.voxels = std::max<int64_t>(form.voxels, 1);
    form.mm3 = std::max(form.mm3, 0.0);
    if (is_in_mm3)
        op.mm3 = form.mm3;
    else
        op.voxels = form.voxels;
}

}  // namespace

std::string islands_rows(IslandsOp& op, const Model& model, const std::optional<glm::dvec3>& clicked)
{
    using Keep = IslandsOp::Keep;
    IslandsForm& form = islands_form;
    if (std::exchange(form.volume, model.session.volume_path) != model.session.volume_path) form.at.reset();
    const auto* const kept = std::ranges::find(KEPT, op.keep, &std::pair<Keep, const char*>::first);
    field_name("Keep");
    if (ImGui::BeginCombo("##keep", kept->second)) {
        for (const auto& [keep, words] : KEPT)
            if (ImGui::Selectable(words, keep == op.keep)) op.keep = keep;
        ImGui::EndCombo();
    }
    hint("The other parts are erased");
    op.voxels.reset();
    op.mm3.reset();
    op.at.reset();
    if (op.keep == Keep::at_least) fewest_row(op, model);
    if (op.keep == Keep::at) {
        if (clicked) form.at = glm::floor(*clicked);
        op.at = form.at;
        field_name("At voxel");
        glm::dvec3 shown = form.at.value_or(glm::dvec3(0.0));
        if (number_fields("##at", shown)) form.at = shown;
        hint("A voxel of the part, x, y and z, counted from 0; a click in the picture or in a slice fills it in");
    }
    group_row("Split from", op.split_from, model, op.keep == Keep::all ? "choose a group" : "no: one group", false);
    hint("The largest part gets this group, the next ones get the groups after it");
    if (op.keep == Keep::at && !op.at) return "click the part to keep, in the picture or in a slice";
    if (op.keep == Keep::all && !op.split_from) return "choose the group that the largest part gets: Split from";
    return "";
}

std::string groups_row(const char* name, std::string& text, std::vector<uint8_t>& groups, const Model& model)
{
    constexpr float WIDTH = 12.0f;
    field_name(name);
    ImGui::SetNextItemWidth(width_of_value(WIDTH));
    ImGui::InputTextWithHint("##groups", "all", &text);
    hint("Groups, such as 1, 2; empty: all");
    button_beside_or_below("Active group");
    const int64_t active = std::max<int64_t>(model.brush().group, 1);
    if (ImGui::Button("Active group")) text = std::to_string(active);
    const std::optional<std::vector<uint8_t>> typed = groups_in(text);
    if (typed) groups = *typed;
    if (typed && !groups.empty()) {
        std::string named;
        for (const uint8_t group : groups)
            named += (named.empty() ? "" : ",  ") + label_of_group(model.session.groups, group);
        want_glyphs(named);
        field_name("");
        ImGui::TextWrapped("%s", named.c_str());
    }
    return typed ? "" : sentence("the groups are ", in_quotes(text), "; expected numbers from 1 to 255, such as 1, 2");
}

void length_row(const char* name, double& length, const Model& model)
{
    name_with_unit(name, unit_of_lengths(model.volume));
    number_field((std::string("##") + name).c_str(), length);
    hint(side_in_words(model.volume).c_str());
}

void tolerance_row(std::optional<double>& tolerance, const Model& model)
{
    name_with_unit("Tolerance", unit_of_lengths(model.volume));
    number_field("##tolerance", tolerance);
    hint(sentence("How far nodes may be off the centre line; empty: the longest side of a voxel. ",
                  side_in_words(model.volume))
             .c_str());
}

void margin_row(std::optional<int64_t>& margin)
{
    name_with_unit("Margin", "voxels");
    whole_field("##margin", margin);
    hint(
        "How far groups may grow beyond the box around the seeds; empty: 16 voxels, or the whole box if one limits it");
}

void cut_rows(LassoOp& op, const Model& model)
{
    static double depth = 0.0;
    OutlineTool& tool = outline_tool();
    field_name("Outline");
    const bool is_lasso = tool.shape == OutlineTool::Shape::lasso;
    if (ImGui::RadioButton("Lasso", is_lasso)) tool.shape = OutlineTool::Shape::lasso;
    hint("Drag in the picture with the left button; with Ctrl: a rectangle");
    ImGui::SameLine();
    if (ImGui::RadioButton("Rectangle", !is_lasso)) tool.shape = OutlineTool::Shape::rectangle;
    hint("Drag in the picture with the left button; with Ctrl: a lasso");
    length_row("Depth", depth, model);
    hint(
        "How far the cut reaches: in 3-D from where the visible part begins, in a slice half to either side of it; 0: "
        "through everything");
    depth = std::max(depth, 0.0);
    tool.set(op, depth > 0.0 ? std::optional(depth) : std::nullopt, model);
}

void draw_outline(const Model& model)
{
    const std::optional<OutlineTool::Drawn>& drawn = outline_tool().drawn();
    if (!drawn) return;
    const bool is_seen = std::ranges::any_of(model.panes, [&](const auto& each) {
        return each.pane.shot == drawn->pane.shot && each.pane.box == drawn->pane.box;
    });
    if (!is_seen) return;
    std::vector<ImVec2> points;
    for (const glm::dvec2& pixel : drawn->outline)
        points.emplace_back(float(drawn->origin.x + pixel.x), float(drawn->origin.y + pixel.y));
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const glm::dvec2 size(drawn->pane.pixels());
    list.PushClipRect({float(drawn->origin.x), float(drawn->origin.y)},
                      {float(drawn->origin.x + size.x), float(drawn->origin.y + size.y)});
    // Dark below light, so that it is seen on any picture.
    list.AddPolyline(points.data(), int(points.size()), IM_COL32(20, 20, 20, 200), ImDrawFlags_Closed, 3.5f);
    list.AddPolyline(points.data(), int(points.size()), IM_COL32(255, 220, 80, 255), ImDrawFlags_Closed, 1.5f);
    list.PopClipRect();
}

}  // namespace shvr::ui
