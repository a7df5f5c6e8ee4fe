#pragma once
// Small widgets that panels share. Between Window::begin_ui and Window::present, main thread.

#include <optional>
#include <string>
#include <string_view>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action.h"
#include "ui/panels/style.h"

namespace shvr::ui {

/// A colour that is looked up by its role in the present theme.
struct ThemeColor {
    ColorRole role;
    operator ImU32() const { return shade_of(role); }
};
inline constexpr ThemeColor WARNING{ColorRole::warning}, ERROR_TEXT{ColorRole::error};

/// Adds a tooltip to the widget drawn last, wrapped to a readable width.
void hint(const char* text);
/// Adds a tooltip next to a widget that must stay visible: at its left or right, whichever side has more room.
void hint_beside(const char* text);

/// Draw a label in the left column: text_label for a text next to it, label for a framed widget.
void text_label(const char* text);
void label(const char* text);
/// Draws a label; the next widget takes the rest of the row.
void row(const char* text);

/// Draws a row with a slider, for a value within its limits.
bool slider(const char* label, double& value, double lower, double upper, const char* format,
            ImGuiSliderFlags flags = 0);

/// ImGui::SliderScalar without a label ("##value"), whose number stays readable wherever the handle is. With Shift the
/// handle moves a tenth as far as the mouse.
bool slider_scalar(const char* id, ImGuiDataType type, void* value, const void* lower, const void* upper,
                   const char* format, ImGuiSliderFlags flags = 0);

/// ImGui::DragScalar for a number. With Shift the value changes a tenth as fast.
bool drag_number(const char* id, double& value, double speed, double lower, double upper, const char* format,
                 ImGuiSliderFlags flags = 0);

/// Returns whether the widget drawn last was double-clicked; if so, makes the widget release the mouse.
bool is_double_clicked();

/// Restores a setting's default, or the value chosen for the volume, when the widget drawn last is double-clicked.
/// `key`: as in the table of engine/session, such as "light.ambient". Returns whether the setting was restored, in
/// which case the caller must not send the widget's own change.
bool resets(const char* key, Actions& actions);

/// Returns whether the mouse holds the present window to drag it.
bool is_window_dragged();

/// ImGui::BeginMenu for a menu that is no higher than the window below the menu bar. A higher menu would open under the
/// pointer, and releasing the button would choose an entry; this menu scrolls instead.
bool begin_menu(const char* label, bool is_enabled = true);

/// Call within the main menu bar, after its menus. Escape closes all menus at once, since a parent menu would reopen
/// the nested one under the pointer.
void close_menus_by_escape();

/// ImGui::BeginPopupModal, for every dialog. A dialog blocks what lies behind it from its first frame on: Dear ImGui
/// (1.86) does so from the second one on, and aborts if a tooltip or another window appears behind the dialog before.
bool begin_dialog(const char* title, ImGuiWindowFlags flags);

/// ImGui::EndPopup for a popup of a panel, which Escape closes even while a field in it has the keyboard.
void end_popup();

/// Draws a name that a session keeps, without a visible label ("##name"), to be typed over. Returns the new name once
/// Enter is pressed or the field loses the keyboard, so that it is one step of the history; without blanks around it,
/// and only if it is neither empty nor the old one. Escape keeps the old name.
std::optional<std::string> name_field(const char* id, const std::string& name);

/// Returns what a user wrote, a name or a path, for the label of a widget or the preview of a list, which Dear ImGui
/// would cut at "##". A carriage return, which is not drawn, follows each "#".
std::string verbatim(std::string_view text);

/// Returns the text, or the longest beginning of the text that fits `width`, followed by three dots.
std::string shortened(const std::string& text, float width);

/// Returns a unit in its usual notation.
const char* spelled(const std::string& unit);

}  // namespace shvr::ui
