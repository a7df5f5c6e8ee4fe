#include "ui/panels/dialogs/operation_rows.h"

#include <algorithm>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/text.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/outline_tool.h"
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

}  // namespace

std::string groups_row(const char* name, std::string& text, std::vector<uint8_t>& groups, const Model& model)
{
    constexpr float WIDTH = 12.0f;
    field_name(name);
    ImGui::SetNextItemWidth(WIDTH * ImGui::GetFontSize());
    ImGui::InputTextWithHint("##groups", "all", &text);
    hint("Groups, such as 1, 2; empty: all");
    ImGui::SameLine();
    const int64_t active = std::max<int64_t>(model.brush().group, 1);
    if (ImGui::Button("Active group")) text = std::to_string(active);
    const std::optional<std::vector<uint8_t>> typed = groups_in(text);
    if (typed) groups = *typed;
    return typed ? "" : sentence("the groups are ", in_quotes(text), "; expected numbers from 1 to 255, such as 1, 2");
}

void length_row(const char* name, double& length, const Model& model)
{
    const std::string unit = model.volume.unit.empty()   ? "voxels"
                             : model.volume.unit == "um" ? "\u00b5m"
                                                         : model.volume.unit;
    field_name((std::string(name) + " (" + unit + ")").c_str());
    ImGui::InputDouble((std::string("##") + name).c_str(), &length, 0.0, 0.0, "%.6g");
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
