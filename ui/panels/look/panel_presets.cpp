#include "ui/panels/look/panel_presets.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/text.h"
#include "engine/workbench/actions/action_rows.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/color_field.h"
#include "ui/panels/dialogs/field_widgets.h"
#include "ui/panels/field_keys.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// State of the name dialogs between frames.
struct NameState {
    std::string name;     ///< typed
    std::string renamed;  ///< preset being renamed; empty: the name is for a new preset of the present curve
};
NameState asked;

constexpr float COLORS_WIDTH = 6.0f;  ///< width of the colours in a list row, in font sizes
constexpr const char* ASK_NAME = "Name of the transfer function";

void ask_for_preset_name(const std::string& renamed)
{
    asked = {renamed, renamed};
}

/// Draws the context menu of one of the user's own presets.
bool own_menu(const TransferPreset& preset, Actions& actions)
{
    bool asks = false;
    if (!ImGui::BeginPopupContextItem(("own " + preset.name).c_str())) return false;
    if (ImGui::MenuItem("Rename...")) {
        ask_for_preset_name(preset.name);
        asks = true;
    }
    if (ImGui::BeginMenu("Replace")) {
        if (ImGui::MenuItem("Keep the present curve under this name instead"))
            actions.push_back(KeepPreset{preset.name});
        ImGui::EndMenu();
    }
    if (ImGui::BeginMenu("Remove")) {
        if (ImGui::MenuItem("Remove it, for all scans")) actions.push_back(ForgetPreset{preset.name});
        ImGui::EndMenu();
    }
    ImGui::EndPopup();
    return asks;
}

/// Draws a function's colours from the lowest to the highest intensity, at the right of the row drawn last. A higher
/// bar is more opaque, as in the curve.
void draw_colors(const TransferFunction& function, const VolumeStatistics& statistics)
{
    constexpr float COLUMN = 2.0f;
    const float width = COLORS_WIDTH * ImGui::GetFontSize();
    const ImVec2 corner = ImGui::GetItemRectMax();
    const float left = corner.x - width, top = ImGui::GetItemRectMin().y + 2.0f, bottom = corner.y - 2.0f;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled({left, top}, {corner.x, bottom}, ImU32(ThemeColor{ColorRole::chart}));
    const auto [least, most] = statistics.range();
    for (float x = 0.0f; x < width; x += COLUMN) {
        const double share = (double(x) + 0.5 * double(COLUMN)) / double(width);
        const glm::dvec4 here = function.at(std::lerp(least, most, share));
        if (here.a <= 0.0) continue;
        const float height = float(std::sqrt(here.a)) * (bottom - top);
        list.AddRectFilled({left + x, bottom - height}, {std::min(left + x + COLUMN, corner.x), bottom},
                           ImGui::GetColorU32(encoded(glm::dvec3(here))));
    }
}

/// Draws a row of the list, with the preset's colours. Returns whether the row was chosen.
bool preset_row(const std::string& name, const TransferFunction& function, const Model& model)
{
    const float width = ImGui::CalcTextSize(name.c_str()).x + (COLORS_WIDTH + 1.0f) * ImGui::GetFontSize();
    const bool is_chosen = ImGui::Selectable(verbatim(name).c_str(), false, ImGuiSelectableFlags_None,
                                             {std::max(width, ImGui::GetContentRegionAvail().x), 0.0f});
    draw_colors(function, model.statistics);
    return is_chosen;
}

/// Returns whether a name is asked for.
bool list(const Model& model, Actions& actions)
{
    if (!ImGui::BeginCombo("##presets", "Start from ...", ImGuiComboFlags_HeightLarge)) return false;
    bool asks = false, has_own = false;
    const TransferFunction automatic = automatic_transfer_function(model.statistics);
    if (preset_row("the histogram", automatic, model))
        set(actions, model, [&](Session& s) { s.transfer_function = automatic; });
    if (ImGui::Selectable("a file ...")) actions.push_back(ShowDialog{Dialog::load});
    hint("A transfer function in a file, as those that are kept. Or drop it on the window.");
    for (const TransferPreset& preset : model.presets) {
        if (preset.is_own && !std::exchange(has_own, true)) {
            ImGui::Separator();
            ImGui::TextDisabled("Your own (right click: rename, remove)");
        }
        ImGui::PushID(&preset);
        const TransferFunction function = transfer_function_of(preset, model.statistics);
        if (preset_row(preset.name, function, model))
            set(actions, model, [&](Session& s) { s.transfer_function = function; });
        if (preset.is_own)
            asks |= own_menu(preset, actions);
        else
            hint(preset.note.c_str());
        ImGui::PopID();
    }
    ImGui::EndCombo();
    return asks;
}

/// Returns the reason why the typed name is refused; empty: it is accepted.
std::string why_not_named(const std::string& name, const Model& model)
{
    if (name.empty()) return "Type a name.";
    if (std::string why = why_no_name(name, "transfer function"); !why.empty()) return why;
    const auto there = std::ranges::find(model.presets, name, &TransferPreset::name);
    if (there == model.presets.end()) return {};
    if (!there->is_own) return "A supplied transfer function has this name.";
    return asked.renamed.empty() ? "" : "One that is kept has this name.";
}

void name_dialog(const Model& model, Actions& actions)
{
    size_dialog();
    if (!begin_dialog(ASK_NAME, ImGuiWindowFlags_AlwaysAutoResize)) return;
    static FieldKeys keys;
    keys.before_field(ImGui::IsWindowAppearing());
    ImGui::SetNextItemWidth(18.0f * ImGui::GetFontSize());
    const bool is_entered = ImGui::InputText("##name", &asked.name, ImGuiInputTextFlags_EnterReturnsTrue);
    keys.after_field();
    const std::string name(trimmed(asked.name));
    const std::string why = why_not_named(name, model);
    const auto is_own = [&](const TransferPreset& preset) { return preset.is_own && preset.name == name; };
    if (name.empty())
        dialog_note(why, {});
    else if (asked.renamed.empty() && std::ranges::any_of(model.presets, is_own))
        dialog_note({}, "The one that is kept under this name is replaced.");
    else
        dialog_note("It is kept for all scans, scaled to their intensities.", why);
    ImGui::BeginDisabled(!why.empty());
    const bool is_confirmed = ImGui::Button(asked.renamed.empty() ? "Keep" : "Rename") || (is_entered && why.empty());
    ImGui::EndDisabled();
    if (is_confirmed) {
        if (asked.renamed.empty())
            actions.push_back(KeepPreset{name});
        else
            actions.push_back(RenamePreset{asked.renamed, name});
        ImGui::CloseCurrentPopup();
    }
    ImGui::SameLine();
    if (ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

}  // namespace

void preset_line(const Model& model, Actions& actions)
{
    const float width = ImGui::CalcTextSize("Keep...").x + 2.0f * ImGui::GetStyle().FramePadding.x;
    ImGui::SetNextItemWidth(-width - ImGui::GetStyle().ItemSpacing.x);
    bool asks = list(model, actions);
    ImGui::SameLine();
    const std::string why = why_not(model, KeepPreset{});
    ImGui::BeginDisabled(!why.empty());
    if (ImGui::Button("Keep...")) {
        ask_for_preset_name({});
        asks = true;
    }
    ImGui::EndDisabled();
    hint(why.empty() ? "Keeps this curve under a name, for all scans." : why.c_str());
    if (asks) ImGui::OpenPopup(ASK_NAME);
    name_dialog(model, actions);
}

}  // namespace shvr::ui
