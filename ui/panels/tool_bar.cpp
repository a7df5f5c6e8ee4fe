// The bar below the menu: the active tool and group.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <imgui/imgui.h>

#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/bindings/tools.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/edits/group_steps.h"
#include "ui/panels/color_field.h"
#include "ui/panels/panels.h"
#include "ui/panels/signs/signs.h"
#include "ui/panels/style.h"
#include "ui/panels/tools/outline_tool.h"
#include "ui/panels/tools/point_tool.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr float NAMED_FROM = 74.0f;  ///< minimum width, in font sizes, at which tools show their names
constexpr float GROUP_WIDTH = 13.0f, MIN_GROUP_WIDTH = 4.0f;  ///< widths of the active group's name, in font sizes
constexpr float GAP = 0.25f;                                  ///< between neighbouring buttons, in font sizes
constexpr const char *CLIP_BOX = "Clip box", *CUT_PLANE = "Cut plane";

/// Returns the tooltip of a tool: its name, its key, and the effect of a click.
std::string explanation(const ToolRow& row, const Keymap& keymap)
{
    return sentence(row.name, key_in_brackets(row.shortcut, keymap), "\n", row.hint);
}

float sign_size()
{
    return 1.1f * ImGui::GetFontSize();
}

float signed_width(const char* name, bool has_name)
{
    const ImGuiStyle& style = ImGui::GetStyle();
    const float words = has_name ? ImGui::CalcTextSize(name).x + style.ItemInnerSpacing.x : 0.0f;
    return 2.0f * style.FramePadding.x + sign_size() + words;
}

/// Draws a button with a sign, and its name if there is room; one in use has another background. Returns whether it was
/// pressed.
template <class DrawSign>
bool signed_button(const char* name, bool has_name, bool is_used, const DrawSign& draw)
{
    const ImGuiStyle& style = ImGui::GetStyle();
    const float height = ImGui::GetFrameHeight(), sign = sign_size();
    ImGui::PushStyleColor(ImGuiCol_Button, color_of(is_used ? ColorRole::chosen : ColorRole::bar));
    const bool is_pressed = ImGui::Button(sentence("##", name).c_str(), {signed_width(name, has_name), height});
    ImGui::PopStyleColor();
    const ImVec2 begin = ImGui::GetItemRectMin();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);  // paler where the button is disabled
    draw(Pen{list, {begin.x + style.FramePadding.x, begin.y + 0.5f * (height - sign)}, sign, color});
    if (has_name)
        list.AddText({begin.x + style.FramePadding.x + sign + style.ItemInnerSpacing.x, begin.y + style.FramePadding.y},
                     color, name);
    return is_pressed;
}

/// Draws the button of a tool. The active tool is marked by a background and an underline.
void tool_button(const ToolRow& row, bool has_name, const Model& model, Actions& actions)
{
    const bool is_used = model.tool() == row.tool;
    ImGui::PushID(row.shortcut);
    if (signed_button(row.name, has_name, is_used, [&](const Pen& pen) { draw_sign(row.tool, pen); }))
        if (const Shortcut* const shortcut = shortcut_named(row.shortcut))
            actions.push_back(shortcut->action(model, 1.0));
    hint(explanation(row, model.keymap).c_str());
    if (is_used) {
        const ImVec2 begin = ImGui::GetItemRectMin(), end = ImGui::GetItemRectMax();
        const float stroke = std::max(2.0f, 0.14f * ImGui::GetFontSize());
        ImGui::GetWindowDrawList()->AddRectFilled({begin.x, end.y - stroke}, end, shade_of(ColorRole::accent_strong));
    }
    ImGui::PopID();
    ImGui::SameLine(0.0f, GAP * ImGui::GetFontSize());
}

/// Draws a square in the group's colour; the eraser's square is crossed out.
void swatch(const Model& model, uint8_t group)
{
    const float size = ImGui::GetFrameHeight();
    ImGui::Dummy({size, size});
    const ImVec2 begin = ImGui::GetItemRectMin(), end = ImGui::GetItemRectMax();
    const float inset = 0.12f * size;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 from{begin.x + inset, begin.y + inset}, to{end.x - inset, end.y - inset};
    if (group != 0)
        list.AddRectFilled(from, to,
                           ImGui::ColorConvertFloat4ToU32(encoded(group_of(model.session.groups, group).color)), 2.0f);
    list.AddRect(from, to, shade_of(ColorRole::line), 2.0f);
    if (group == 0) {
        list.AddLine(from, to, shade_of(ColorRole::line), 1.5f);
        list.AddLine({from.x, to.y}, {to.x, from.y}, shade_of(ColorRole::line), 1.5f);
    }
}

std::string label_of_group(const Model& model, uint8_t group)
{
    if (group == 0) return "0  eraser";
    return sentence(int(group), "  ", group_of(model.session.groups, group).name);
}

/// Draws a button for a shortcut, with a symbol as its label.
void step_button(const char* sign, const char* id, const Model& model, Actions& actions)
{
    const Shortcut* const shortcut = shortcut_named(id);
    if (!shortcut) return;
    const float size = ImGui::GetFrameHeight();
    if (ImGui::Button(sentence(sign, "##", id).c_str(), {size, size})) actions.push_back(shortcut->action(model, 1.0));
    hint(name_with_key(id, model.keymap).c_str());
    ImGui::SameLine(0.0f, GAP * ImGui::GetFontSize());
}

/// What has room right of the tools.
struct Room {
    bool has_names = true;  ///< on the buttons of cuts
    float group_width = 0.0f;
};

/// `width`: from the first button of cuts to the end of the bar.
Room room_in(float width)
{
    const float font = ImGui::GetFontSize(), gap = GAP * font;
    const float steps_and_swatch = 4.0f * ImGui::GetFrameHeight() + 5.0f * gap;
    const auto room_for_group = [&](bool has_names) {
        const float cuts = signed_width(CLIP_BOX, has_names) + gap + signed_width(CUT_PLANE, has_names) + font;
        return width - cuts - steps_and_swatch;
    };
    const bool has_names = room_for_group(true) >= GROUP_WIDTH * font;
    return {has_names, std::clamp(room_for_group(has_names), MIN_GROUP_WIDTH * font, GROUP_WIDTH * font)};
}

/// Draws the button that shows the clip box with its handles.
void clip_button(bool has_name, const Model& model, Actions& actions)
{
    const Shortcut* const shortcut = shortcut_named("cut_box");
    if (!shortcut) return;
    const bool is_shown = model.session.view.cut_box;
    ImGui::BeginDisabled(!model.is_open);
    if (signed_button(CLIP_BOX, has_name, is_shown, draw_clip_box)) actions.push_back(shortcut->action(model, 1.0));
    ImGui::EndDisabled();
    hint((name_with_key("cut_box", model.keymap) + "\nDrag a handle to cut the volume open.").c_str());
    ImGui::SameLine(0.0f, GAP * ImGui::GetFontSize());
}

/// Draws the button that adds the oblique cutting plane, or removes it.
void plane_button(bool has_name, const Model& model, Actions& actions)
{
    const bool has_plane = model.session.cut.plane_normal.has_value();
    const char* const id = has_plane ? "remove_oblique_cut" : "oblique_cut";
    const Shortcut* const shortcut = shortcut_named(id);
    if (!shortcut) return;
    ImGui::BeginDisabled(!model.is_open);
    if (signed_button(CUT_PLANE, has_name, has_plane, draw_cut_plane)) actions.push_back(shortcut->action(model, 1.0));
    ImGui::EndDisabled();
    hint((name_with_key(id, model.keymap) +
          (has_plane ? "" : "\nIt removes the half towards you. Drag its handles to move and tilt it."))
             .c_str());
    ImGui::SameLine(0.0f, ImGui::GetFontSize());
}

void active_group(float width, const Model& model, Actions& actions)
{
    const uint8_t group = model.brush().group;
    step_button("<", "previous_group", model, actions);
    swatch(model, model.session.probe.painted_group());
    ImGui::SameLine(0.0f, GAP * ImGui::GetFontSize());
    ImGui::SetNextItemWidth(width);
    const bool erases = model.tool() == Tool::erase;
    const std::string shown = erases ? "erases any group" : label_of_group(model, group);
    const float room = width - ImGui::GetFrameHeight() - 2.0f * ImGui::GetStyle().FramePadding.x;
    if (ImGui::BeginCombo("##group", shortened(verbatim(shown), room).c_str(), ImGuiComboFlags_HeightLarge)) {
        for (const uint8_t each : known_groups(model)) {
            ImGui::PushID(int{each});
            swatch(model, each);
            ImGui::SameLine();
            if (ImGui::Selectable(verbatim(label_of_group(model, each)).c_str(), each == group))
                set(actions, model, [&](Session& s) { s.probe.brush.group = each; });
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    hint(erases ? "The active group stays as it is, and is painted again with another tool."
                : (shown + "\nThe active group: what painting and tracing belong to.").c_str());
    ImGui::SameLine(0.0f, GAP * ImGui::GetFontSize());
    step_button(">", "next_group", model, actions);
    step_button("+", "new_group", model, actions);
}

/// Returns as many parts of the words, which commas separate, as have room; empty: none has.
std::string parts_within(float width, const std::string& words)
{
    if (ImGui::CalcTextSize(words.c_str()).x <= width) return words;
    for (size_t end = words.size(); (end = words.substr(0, end).rfind(", ")) != std::string::npos;) {
        const std::string parts = words.substr(0, end) + ", ...";
        if (ImGui::CalcTextSize(parts.c_str()).x <= width) return parts;
    }
    return {};
}

/// Describes the mouse over each kind of pane that is shown, in a line each: the pointer that rests on the bar is over
/// none of them.
std::string mouse_over_panes(const Model& model)
{
    constexpr std::pair<Pane::Kind, const char*> PLACES[] = {{Pane::Kind::main, "Over the volume, "},
                                                             {Pane::Kind::slice, "Over a slice, "},
                                                             {Pane::Kind::map, "Over a map, "}};
    std::string lines;
    for (const auto& place : PLACES) {
        const auto is_it = [&](const auto& part) { return part.pane.kind == place.first; };
        if (place.first != Pane::Kind::main && std::ranges::none_of(model.panes, is_it)) continue;
        if (!lines.empty()) lines += '\n';
        lines += place.second + mouse_in_words(model.tool(), place.first, model.preferences.key_set);
    }
    return lines;
}

/// Shows the functions of the mouse buttons, as far as they have room; a tooltip shows all of them.
void mouse_words(const Model& model)
{
    const bool is_over_pane = model.pointer && model.pointer->pane < model.panes.size();
    const Pane::Kind over = is_over_pane ? model.panes[model.pointer->pane].pane.kind : Pane::Kind::main;
    const bool cuts = outline_tool().is_on() && over != Pane::Kind::map;
    const bool points = point_tool().is_on() && over != Pane::Kind::map;
    const std::string words = cuts     ? "left: draw the outline of the cut, Shift + left: move"
                              : points ? "left: answer where, for the operation; Shift + left: move"
                                       : mouse_in_words(model.tool(), over, model.preferences.key_set);
    ImGui::SameLine(0.0f, ImGui::GetFontSize());
    ImGui::AlignTextToFramePadding();
    const TextIn small(TextRole::small);
    const float room = ImGui::GetContentRegionAvail().x;
    std::string shown = parts_within(room, "Mouse  " + words);
    if (shown.empty()) shown = parts_within(room, "Mouse (?)");
    if (shown.empty()) return;
    ImGui::TextDisabled("%s", shown.c_str());
    hint(sentence(cuts || points ? words : mouse_over_panes(model), "\n", row_of(model.tool()).hint,
                  "\nAlt + left drag turns, Shift + left drag moves.")
             .c_str());
}

}  // namespace

float tool_bar_height()
{
    return ImGui::GetFrameHeight() + 2.0f * ImGui::GetStyle().FramePadding.y + 2.0f;
}

void tool_bar(const ImVec2& at, float width, const Model& model, Actions& actions)
{
    const ImGuiStyle& style = ImGui::GetStyle();
    ImGui::SetNextWindowPos(at);
    ImGui::SetNextWindowSize({width, tool_bar_height()});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {style.FramePadding.x, style.FramePadding.y + 1.0f});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1.0f, 1.0f});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, color_of(ColorRole::bar));
    ImGui::Begin("Tools", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoScrollWithMouse);
    const bool has_names = width >= NAMED_FROM * ImGui::GetFontSize();
    for (const ToolRow& row : tool_rows()) tool_button(row, has_names, model, actions);
    ImGui::SameLine(0.0f, ImGui::GetFontSize());
    const Room room = room_in(ImGui::GetContentRegionAvail().x);
    clip_button(room.has_names, model, actions);
    plane_button(room.has_names, model, actions);
    active_group(room.group_width, model, actions);
    mouse_words(model);
    ImGui::End();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar(4);
}

}  // namespace shvr::ui
