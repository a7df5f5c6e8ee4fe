#pragma once
// Small widgets that panels share. Between Window::begin_ui and Window::present, main thread.

#include <string>

#include <imgui/imgui.h>

namespace shvr::ui {

inline constexpr ImU32 WARNING = IM_COL32(242, 184, 90, 255);

/// A tooltip for the widget drawn last, wrapped to a readable width.
void hint(const char* text);

/// Labels form one column at the left, with their text or framed widget beside them.
void text_label(const char* text);
void label(const char* text);

/// A slider as wide as the panel, for a value within its limits.
bool slider(const char* label, double& value, double lower, double upper, const char* format,
            ImGuiSliderFlags flags = 0);

/// A unit in its usual notation.
const char* spelled(const std::string& unit);

}  // namespace shvr::ui
