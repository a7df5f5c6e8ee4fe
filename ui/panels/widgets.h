#pragma once
// Small widgets that panels share. Between Window::begin_ui and Window::present, main thread.

#include <string>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action.h"
#include "ui/panels/style.h"

namespace shvr::ui {

/// A colour by what it is for, as the present theme has it.
struct ThemeColor {
    ColorRole role;
    operator ImU32() const { return shade_of(role); }
};
inline constexpr ThemeColor WARNING{ColorRole::warning}, ERROR_TEXT{ColorRole::error};

/// A tooltip for the widget drawn last, wrapped to a readable width.
void hint(const char* text);
/// The same beside a widget that one looks at while one reads: to the left or the right, where there is more room.
void hint_beside(const char* text);

/// Labels form one column at the left, with their text or framed widget beside them.
void text_label(const char* text);
void label(const char* text);
/// A label; the widget after it takes the rest of the row.
void row(const char* text);

/// A row with a slider, for a value within its limits.
bool slider(const char* label, double& value, double lower, double upper, const char* format,
            ImGuiSliderFlags flags = 0);

/// ImGui::SliderScalar with its number readable wherever the handle is, and without a label: "##value". With Shift the
/// handle goes a tenth as far as the mouse.
bool slider_scalar(const char* id, ImGuiDataType type, void* value, const void* lower, const void* upper,
                   const char* format, ImGuiSliderFlags flags = 0);

/// ImGui::DragScalar of a number, that goes a tenth as far with Shift.
bool drag_number(const char* id, double& value, double speed, double lower, double upper, const char* format,
                 ImGuiSliderFlags flags = 0);

/// Whether the widget drawn last was double-clicked; it lets go of the mouse then, and would else follow it.
bool is_double_clicked();

/// A double click on the widget drawn last gives a setting what ships, or what is chosen for the volume: its key as in
/// the table of engine/session, "light.ambient". Returns whether that happened, so that the widget's own change is not
/// sent as well.
bool resets(const char* key, Actions& actions);

/// ImGui::BeginMenu, no higher than the window below the menu bar: it scrolls instead of opening under the pointer,
/// where the release of the click that opened it would choose an entry.
bool begin_menu(const char* label, bool is_enabled = true);

/// Within the main menu bar, after its menus: Escape closes all of them, since one within another would open again
/// under the pointer.
void close_menus_by_escape();

/// The text, or as much of its beginning as fits that width, with three dots.
std::string shortened(const std::string& text, float width);

/// A unit in its usual notation.
const char* spelled(const std::string& unit);

}  // namespace shvr::ui
