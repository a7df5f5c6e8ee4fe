#pragma once
// Small widgets that panels share. Between Window::begin_ui and Window::present, main thread.

#include <string>

#include <imgui/imgui.h>

namespace shvr::ui {

/// A tooltip for the widget drawn last, wrapped to a readable width.
void hint(const char* text);

/// Labels stand at the left in one column, what belongs to them beside: text, or something with a frame.
void text_label(const char* text);
void label(const char* text);

/// A slider in the width of a panel, of a value that stays within its ends.
bool slider(const char* label, double& value, double lower, double upper, const char* format,
            ImGuiSliderFlags flags = 0);

/// A unit as a person writes it.
const char* spelled(const std::string& unit);

}  // namespace shvr::ui
