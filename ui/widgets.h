#pragma once
// Small widgets that panels share. Between Window::begin_ui and Window::present, main thread.

namespace shvr::ui {

/// A tooltip for the widget drawn last, wrapped to a readable width.
void hint(const char* text);

}  // namespace shvr::ui
