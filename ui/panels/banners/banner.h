#pragma once
// A banner: a notice with buttons over the whole width of the graphics window, which stays until its cause is gone or
// the user dismisses it. Between Window::begin_ui and Window::present, main thread.

#include <glm/vec2.hpp>

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// Begins a banner with its upper left corner at `begin`. Draw the buttons first, then the text, wrapped.
void begin_banner(const char* name, const glm::vec2& begin, float width);
/// Ends it, and returns its height.
float end_banner();

/// Says what an unfinished import has left, and offers to go on with it or to delete it. Returns its height.
float unfinished_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions);
/// Says that the window closes once files are written, and offers to cancel either. Returns its height.
float closing_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions);
/// Says why work cannot be saved now, and offers what helps. Returns its height.
float trouble_banner(const Model& model, const glm::vec2& begin, float width, Actions& actions);

}  // namespace shvr::ui
