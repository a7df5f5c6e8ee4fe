#pragma once
// Small widgets that panels share. Between Window::begin_ui and Window::present, main thread.

#include <string>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action.h"
#include "ui/panels/style.h"

namespace shvr::ui {

/// A colour by its role, from the present theme.
struct ThemeColor {
    ColorRole role;
    operator ImU32() const { return shade_of(role); }
};
inline constexpr ThemeColor WARNING{ColorRole::warning}, ERROR_TEXT{ColorRole::error};

/// Adds a tooltip to the widget drawn last, wrapped to a readable width.
void hint(const char* text);
/// Likewise, but next to a widget that must stay visible: at its left or right, whichever side has more room.
void hint_beside(const char* text);

/// Draws a label in the left column, for a text (text_label) or a framed widget (label) next to it.
void text_label(const char* text);
void label(const char* text);
/// Draws a label; the widget after it takes the rest of the row.
void row(const char* text);

/// Draws a row with a slider, for a value within its limits.
bool slider(const char* label, double& value, double lower, double upper, const char* format,
            ImGuiSliderFlags flags = 0);

/// ImGui::SliderScalar with a number that is readable wherever the handle is, and without a label: "##value". With
/// Shift the handle moves a tenth as far as the mouse.
bool slider_scalar(const char* id, ImGuiDataType type, void* value, const void* lower, const void* upper,
                   const char* format, ImGuiSliderFlags flags = 0);

/// ImGui::DragScalar of a number; with Shift the value changes a tenth as fast.
bool drag_number(const char* id, double& value, double speed, double lower, double upper, const char* format,
                 ImGuiSliderFlags flags = 0);

/// Returns whether the widget drawn last was double-clicked, and if so makes it release the mouse.
bool is_double_clicked();

/// Restores a setting's default, or the value chosen for the volume, on a double click on the widget drawn last.
/// `key`: as in the table of engine/session, "light.ambient". Returns whether that happened, so that the widget's own
/// change is not sent as well.
bool resets(const char* key, Actions& actions);

/// ImGui::BeginMenu, no higher than the window below the menu bar: it scrolls instead of opening under the pointer,
/// where the release of the click that opened it would choose an entry.
bool begin_menu(const char* label, bool is_enabled = true);

/// Call within the main menu bar, after its menus: Escape closes all of them, since a nested one would open again
/// under the pointer.
void close_menus_by_escape();

/// Returns the text, or as much of its beginning as fits that width, followed by three dots.
std::string shortened(const std::string& text, float width);

/// Returns a unit in its usual notation.
const char* spelled(const std::string& unit);

}  // namespace shvr::ui
