#pragma once
// Widgets for the options of a task or any other object that states its keys (engine/session/fields.h): each key by its
// name, with its meaning as a tooltip. Between Window::begin_ui and Window::present, main thread.

#include "engine/session/fields.h"

namespace shvr::ui {

/// Draws the keys and changes the values. Keys that need a form of their own (Fields::other, lists) are left out.
/// Returns whether a chooser of one of them was in front, which Escape then closed.
bool draw_fields(const Fields::Visit& visit);

}  // namespace shvr::ui
