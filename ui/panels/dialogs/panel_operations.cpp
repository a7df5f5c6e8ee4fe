// Operations on groups: a window in which one is chosen, previewed in the picture and carried out.

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/forms/operation_form.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/dialogs/limit_rows.h"
#include "ui/panels/dialogs/operation_rows.h"
#include "ui/panels/number_field.h"
#include "ui/panels/panels.h"
#include "ui/panels/tools/outline_tool.h"
#include "ui/panels/tools/point_tool.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char* WINDOW = "Operations on groups";
constexpr const char* WINDOW_ID = "operations";
constexpr float MAX_SHARE = 0.4f;  ///< share of the screen's width, since the picture shows the preview

template <size_t... index>
std::array<GroupOperation, sizeof...(index)> one_of_each(std::index_sequence<index...>)
{
    return {GroupOperation(std::in_place_index<index>)...};
}

/// The first suggestion of each operation, where that of scripts lacks something.
std::array<GroupOperation, std::variant_size_v<GroupOperation>> suggestions()
{
    auto operations = one_of_each(std::make_index_sequence<std::variant_size_v<GroupOperation>>());
    for (GroupOperation& each : operations)
        if (auto* const islands = std::get_if<IslandsOp>(&each)) islands->keep = IslandsOp::Keep::largest;
    return operations;
}

/// Between frames. Each operation keeps its own values.
struct OperationsState {
    std::array<GroupOperation, std::variant_size_v<GroupOperation>> operations = suggestions();
    size_t chosen = GroupOperation(GrowOp()).index();
    int64_t group = 0;                              ///< the active group that was last taken over
    std::optional<std::filesystem::path> volume{};  ///< the scan for which distances were suggested
    bool shows_preview = true;
    std::string why_no_limits;  ///< and what the rows of limits or islands lack
    /// What is typed as lists of groups, and why it is none.
    std::array<std::string, std::variant_size_v<GroupOperation>> groups{};
    std::string why_no_groups;
    std::string wanted;           ///< line that is to be previewed; empty: none
    double wanted_since_s = 0.0;  ///< of ImGui::GetTime
    bool is_resting = false;      ///< the preview waits for the values to rest
};
OperationsState state;

/// Takes over a change of the active group, and suggests distances for another scan.
void follow(const Model& model)
{
    const int64_t group = std::max<int64_t>(model.brush().group, 1);
    const glm::dvec3& spacing = model.volume.spacing;
    const bool is_new_scan = std::exchange(state.volume, model.session.volume_path) != model.session.volume_path;
    const double suggested = 2.0 * std::min({spacing.x, spacing.y, spacing.z});
    for (GroupOperation& each : state.operations)
        std::visit(
            [&](auto& op) {
                if constexpr (requires { op.group; })
                    if (state.group != group) op.group = group;
                if constexpr (requires { op.distance; })
                    if (is_new_scan) op.distance = suggested;
                if constexpr (requires { op.wall; })
                    if (is_new_scan) op.wall = suggested;
                if constexpr (requires { op.with; })
                    if (op.with == op.group) op.with = op.group == 1 ? 2 : 1;
                if constexpr (std::is_same_v<std::remove_cvref_t<decltype(op)>, ThresholdOp>)
                    if (is_new_scan) {
                        op.from = suggested_intensity(model.paint_threshold(), model.volume.type);
                        op.to.reset();
                    }
            },
            each);
    state.group = group;
}

/// Takes over the operation that was asked for.
void choose_operation(std::string_view id)
{
    for (size_t i = 0; i < OPERATION_ROWS.size(); ++i)
        if (OPERATION_ROWS[i].id == id) state.chosen = i;
}

void draw_choice(Actions& actions)
{
    field_name("Operation");
    if (ImGui::BeginCombo("##operation", OPERATION_ROWS[state.chosen].title, ImGuiComboFlags_HeightLargest)) {
        for (size_t i = 0; i < OPERATION_ROWS.size(); ++i) {
            if (ImGui::Selectable(OPERATION_ROWS[i].title, i == state.chosen))
                actions.push_back(ShowDialog{Dialog::operation, OPERATION_ROWS[i].id});
            hint(OPERATION_ROWS[i].meaning);
        }
        ImGui::EndCombo();
    }
    field_name("");
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextDisabled("%s", OPERATION_ROWS[state.chosen].meaning);
    ImGui::PopTextWrapPos();
}

void draw_operation(GroupOperation& operation, const Model& model, Actions& actions)
{
    constexpr std::string_view ROWS_OF_THEIR_OWN[]{
        "distance", "wall", "tolerance", "margin",     "group",          "with",         "inside",     "keep",
        "voxels",   "mm3",  "at",        "split_from", "only_unpainted", "plane_normal", "plane_point"};
    state.why_no_groups.clear();
    state.why_no_limits.clear();
    const std::optional<glm::dvec3> clicked = point_tool().take(model.probe_voxel);
    draw_choice(actions);
    std::visit(
        [&](auto& op) {
            using Op = std::remove_cvref_t<decltype(op)>;
            if constexpr (requires { op.to_group; })
                group_row("Into group", op.to_group, model, true);
            else if constexpr (requires { op.group; })
                group_row("Group", op.group, model);
            if constexpr (requires { op.with; }) group_row("With", op.with, model);
            if constexpr (std::is_same_v<Op, IslandsOp>) state.why_no_limits = islands_rows(op, model, clicked);
            draw_fields([&](Fields& f) { operation_fields(f, op); }, {}, false, ROWS_OF_THEIR_OWN);
            if constexpr (requires { op.distance; }) length_row("Distance", op.distance, model);
            if constexpr (requires { op.wall; }) length_row("Wall", op.wall, model);
            if constexpr (requires { op.tolerance; }) tolerance_row(op.tolerance, model);
            if constexpr (requires { op.margin; }) margin_row(op.margin);
            if constexpr (requires { op.groups; })
                state.why_no_groups = groups_row("Groups", state.groups[state.chosen], op.groups, model);
            if constexpr (requires { op.of; })
                state.why_no_groups = groups_row("Of groups", state.groups[state.chosen], op.of, model);
            if constexpr (std::is_same_v<Op, LassoOp>) cut_rows(op, model);
            if constexpr (requires { op.limits; }) {
                constexpr bool HAS_RANGE = std::is_same_v<Op, ThresholdOp>;
                const std::string why = limit_rows(op.limits, model, clicked, !HAS_RANGE);
                if (state.why_no_limits.empty()) state.why_no_limits = why;
            }
        },
        operation);
}

/// Whether the window waits for a click in the picture.
bool awaits_click(const GroupOperation& operation)
{
    const auto* const islands = std::get_if<IslandsOp>(&operation);
    const bool has_limits = !std::holds_alternative<TraceFromMaskOp>(operation);
    return (islands && islands->keep == IslandsOp::Keep::at) || (has_limits && limit_rows_take_clicks());
}

/// Returns why the operation cannot be carried out; empty: it can.
std::string refusal(const Model& model, const GroupOperation& operation, const std::string& line)
{
    if (std::string why = refused_number(); !why.empty()) return why;
    if (!state.why_no_groups.empty()) return state.why_no_groups;
    if (!state.why_no_limits.empty()) return state.why_no_limits;
    if (const auto* const cut = std::get_if<LassoOp>(&operation); cut && cut->polygon.empty())
        return "draw an outline: drag in the picture with the left button";
    try {
        static_cast<void>(read_action(line, WINDOW));
    } catch (const Error& error) {
        const std::string words = error.what(), begin = std::string(WINDOW) + ": ";
        return with_label(words.starts_with(begin) ? words.substr(begin.size()) : words);
    }
    return std::visit([&](const auto& op) { return why_not(model, Action(op)); }, operation);
}

void apply(const GroupOperation& operation, Actions& actions)
{
    std::visit([&](const auto& op) { actions.push_back(op); }, operation);
    outline_tool().clear();
}

/// Starts the preview of a line that has not changed for a moment: not every key that is typed starts one.
void follow_preview(const Model& model, const std::string& line, bool is_possible, Actions& actions)
{
    constexpr double REST_S = 0.3;
    const bool is_wanted = state.shows_preview && is_possible && line != model.applied;
    const std::string wanted = is_wanted ? line : std::string();
    if (std::exchange(state.wanted, wanted) != wanted) state.wanted_since_s = ImGui::GetTime();
    const bool is_known =
        model.previewed == wanted && (wanted.empty() || model.is_previewing || model.is_preview_current);
    state.is_resting = !is_known && ImGui::GetTime() < state.wanted_since_s + REST_S;
    if (!is_known && !state.is_resting) actions.push_back(PreviewOperation{wanted});
}

/// Draws what the preview has found, or why there is none.
void draw_note(const Model& model, const std::string& line, const std::string& why)
{
    const bool is_complete = model.previewed == line && model.is_preview_current;
    if (!why.empty()) return dialog_note("", why);
    if (!state.shows_preview) return dialog_note("", "");
    if (line == model.applied)
        return dialog_note(model.is_applying ? "This is being applied."
                                             : "This was applied. The next change, or Undo, shows a preview again.",
                           "");
    if (!is_complete) return dialog_note("The preview is not complete yet; Apply does not wait for it.", "");
    if (model.has_preview_failed) return dialog_note("", with_label(model.preview_words));
    dialog_note(model.preview_words, "");
}

}  // namespace

bool operations_window_waits()
{
    return state.is_resting;
}

void operations_window(const Model& model, Actions& actions)
{
    state.is_resting = false;
    if (model.dialog != Dialog::operation || !model.is_open) {
        if (!model.previewed.empty()) actions.push_back(PreviewOperation{});
        outline_tool().set_on(false);
        point_tool().set_on(false);
        return;
    }
    choose_operation(model.operation);
    follow(model);
    const ImGuiViewport& screen = *ImGui::GetMainViewport();
    const float lower_edge = screen.WorkPos.y + screen.WorkSize.y - 2.0f * ImGui::GetFontSize();
    size_dialog(MAX_SHARE);
    // At first over the side panel rather than over the picture.
    place_kept_corner(WINDOW_ID, {screen.WorkPos.x + screen.WorkSize.x, lower_edge}, model);
    bool is_shown = true;
    const bool is_drawn =
        ImGui::Begin(WINDOW, &is_shown, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    point_tool().set_on(is_drawn && awaits_click(state.operations[state.chosen]));
    outline_tool().set_on(is_drawn && std::holds_alternative<LassoOp>(state.operations[state.chosen]));
    if (is_drawn) {
        keep_above(lower_edge);
        keep_corner(WINDOW_ID, actions);
        const OutlineTool::Wish wish = outline_tool().take_wish();
        if (wish == OutlineTool::Wish::cancel) outline_tool().clear();
        draw_operation(state.operations[state.chosen], model, actions);
        const GroupOperation operation = state.operations[state.chosen];
        const std::string line = std::visit([](const auto& op) { return line_of(Action(op)); }, operation);
        const std::string why = refusal(model, operation, line);
        ImGui::Checkbox("Preview", &state.shows_preview);
        hint("Shows in the picture which voxels would change, and counts them, whenever a value is changed");
        follow_preview(model, line, why.empty(), actions);
        draw_outline(model);
        // Room for two lines, so that the buttons stay where they are when other words come.
        const float below = ImGui::GetCursorPosY() + 2.0f * ImGui::GetTextLineHeightWithSpacing();
        draw_note(model, line, why);
        ImGui::SetCursorPosY(std::max(ImGui::GetCursorPosY(), below));
        const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
        ImGui::BeginDisabled(!why.empty());
        if (ImGui::Button("Apply", button) || (why.empty() && wish == OutlineTool::Wish::apply))
            apply(operation, actions);
        ImGui::EndDisabled();
        hint("Changes the voxels; Undo takes it back");
        ImGui::SameLine();
        if (ImGui::Button("Done", button)) is_shown = false;  // "Close" is an operation
    }
    ImGui::End();
    if (!is_shown) actions.push_back(ShowDialog{});
}

}  // namespace shvr::ui
