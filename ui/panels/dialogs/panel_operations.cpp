// Operations on groups: a window in which one is chosen, previewed in the picture and carried out.

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action_rows.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char* WINDOW = "Operations on groups";

template <size_t... index>
std::array<GroupOperation, sizeof...(index)> one_of_each(std::index_sequence<index...>)
{
    return {GroupOperation(std::in_place_index<index>)...};
}

/// Between frames. Each operation keeps its own values.
struct OperationsState {
    std::array<GroupOperation, std::variant_size_v<GroupOperation>> operations =
        one_of_each(std::make_index_sequence<std::variant_size_v<GroupOperation>>());
    size_t chosen = GroupOperation(GrowOp()).index();
    int64_t group = 0;     ///< the active group that was last taken over
    uint64_t opening = 0;  ///< the document for which distances were suggested
    bool shows_preview = true;
    bool is_limited_to_view = false, is_limited_to_group = false;
    std::string applied;  ///< line that was carried out last; it is not previewed again until something is changed
};
OperationsState state;

/// Takes over a change of the active group, and suggests distances for another scan.
void follow(const Model& model)
{
    const int64_t group = std::max<int64_t>(model.brush().group, 1);
    const glm::dvec3& spacing = model.volume.spacing;
    const double suggested = 2.0 * std::min({spacing.x, spacing.y, spacing.z});
    for (GroupOperation& each : state.operations)
        std::visit(
            [&](auto& op) {
                if constexpr (requires { op.group; })
                    if (state.group != group) op.group = group;
                if constexpr (requires { op.distance; })
                    if (!(op.distance > 0.0)) op.distance = suggested;
                if constexpr (requires { op.wall; })
                    if (!(op.wall > 0.0)) op.wall = suggested;
                if constexpr (std::is_same_v<std::remove_cvref_t<decltype(op)>, ThresholdOp>)
                    if (state.group == 0) op.from = model.paint_threshold();
            },
            each);
    state.group = group;
}

/// Takes what the check boxes say into the operation.
void limit(GroupOperation& operation, const Model& model)
{
    std::visit(
        [&](auto& op) {
            if constexpr (requires { op.limits; }) {
                const CutBox& cut = model.session.cut;
                const VoxelBox visible{glm::max(Size3(glm::floor(cut.lower)), Size3(0)),
                                       glm::min(Size3(glm::ceil(cut.upper)), Size3(model.volume.size))};
                op.limits.box = state.is_limited_to_view ? std::optional(visible) : std::nullopt;
            }
            if constexpr (requires { op.groups; })
                op.groups =
                    state.is_limited_to_group ? std::vector<uint8_t>{uint8_t(state.group)} : std::vector<uint8_t>{};
        },
        operation);
}

void draw_choice()
{
    field_name("Operation");
    if (ImGui::BeginCombo("##operation", OPERATION_ROWS[state.chosen].title, ImGuiComboFlags_HeightLargest)) {
        for (size_t i = 0; i < OPERATION_ROWS.size(); ++i) {
            if (ImGui::Selectable(OPERATION_ROWS[i].title, i == state.chosen)) state.chosen = i;
            hint(OPERATION_ROWS[i].meaning);
        }
        ImGui::EndCombo();
    }
    field_name("");
    ImGui::TextDisabled("%s", OPERATION_ROWS[state.chosen].meaning);
}

void draw_length(const char* name, double& length, const Model& model)
{
    const std::string unit = model.volume.unit.empty()   ? "voxels"
                             : model.volume.unit == "um" ? "\u00b5m"
                                                         : model.volume.unit;
    field_name((std::string(name) + " (" + unit + ")").c_str());
    ImGui::InputDouble((std::string("##") + name).c_str(), &length, 0.0, 0.0, "%.6g");
}

void draw_operation(GroupOperation& operation, const Model& model)
{
    constexpr std::string_view ROWS_OF_THEIR_OWN[]{"distance", "wall", "inside"};
    draw_choice();
    draw_fields([&](Fields& f) { std::visit([&](auto& op) { operation_fields(f, op); }, operation); }, {}, false,
                ROWS_OF_THEIR_OWN);
    std::visit(
        [&](auto& op) {
            if constexpr (requires { op.distance; }) draw_length("Distance", op.distance, model);
            if constexpr (requires { op.wall; }) draw_length("Wall", op.wall, model);
            if constexpr (requires { op.groups; }) {
                field_name("Groups");
                ImGui::Checkbox("Only the active group", &state.is_limited_to_group);
            }
            if constexpr (requires { op.limits; }) {
                field_name("Where");
                ImGui::Checkbox("Only in the visible part (cutting planes)", &state.is_limited_to_view);
            }
        },
        operation);
}

/// Returns why the operation cannot be carried out; empty: it can.
std::string refusal(const Model& model, const GroupOperation& operation, const std::string& line)
{
    try {
        static_cast<void>(read_action(line, WINDOW));
    } catch (const Error& error) {
        const std::string words = error.what(), begin = std::string(WINDOW) + ": ";
        return words.starts_with(begin) ? words.substr(begin.size()) : words;
    }
    return std::visit([&](const auto& op) { return why_not(model, Action(op)); }, operation);
}

void follow_preview(const Model& model, const std::string& line, bool is_possible, Actions& actions)
{
    const std::string wanted = state.shows_preview && is_possible && line != state.applied ? line : std::string();
    const bool is_known =
        model.previewed == wanted && (wanted.empty() || model.is_previewing || model.is_preview_current);
    if (is_known || (wanted.empty() && model.previewed.empty())) return;
    if (ImGui::IsAnyItemActive() && !wanted.empty()) return;  // a value is being typed or dragged
    actions.push_back(PreviewOperation{wanted});
}

}  // namespace

void operations_window(const Model& model, Actions& actions)
{
    if (model.dialog != Dialog::operation || !model.is_open) {
        if (!model.previewed.empty()) actions.push_back(PreviewOperation{});
        return;
    }
    follow(model);
    // Over the side panel rather than over the picture.
    const ImGuiViewport& screen = *ImGui::GetMainViewport();
    ImGui::SetNextWindowPos(
        {screen.WorkPos.x + screen.WorkSize.x, screen.WorkPos.y + screen.WorkSize.y - 2.0f * ImGui::GetFontSize()},
        ImGuiCond_Appearing, {1.0f, 1.0f});
    size_dialog();
    bool is_shown = true;
    const bool is_drawn =
        ImGui::Begin(WINDOW, &is_shown, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
    if (is_drawn) {
        draw_operation(state.operations[state.chosen], model);
        GroupOperation operation = state.operations[state.chosen];
        limit(operation, model);
        const std::string line = std::visit([](const auto& op) { return line_of(Action(op)); }, operation);
        const std::string why = refusal(model, operation, line);
        ImGui::Checkbox("Preview", &state.shows_preview);
        hint("Shows in the picture which voxels would change, and counts them");
        follow_preview(model, line, why.empty(), actions);
        const bool is_about_it = model.previewed == line && !model.preview_words.empty();
        const std::string known = model.is_previewing ? "Computing the preview"
                                  : is_about_it       ? model.preview_words
                                                      : "";
        dialog_note(model.has_preview_failed ? "" : known, !why.empty() ? why : model.has_preview_failed ? known : "");
        const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
        ImGui::BeginDisabled(!why.empty());
        if (ImGui::Button("Apply", button)) {
            state.applied = line;
            std::visit([&](const auto& op) { actions.push_back(op); }, operation);
        }
        ImGui::EndDisabled();
        hint("Changes the voxels; Undo takes it back");
        ImGui::SameLine();
        if (ImGui::Button("Close", button)) is_shown = false;
    }
    ImGui::End();
    if (!is_shown) actions.push_back(ShowDialog{});
}

}  // namespace shvr::ui
