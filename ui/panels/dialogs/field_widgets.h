#pragma once
// Widgets for the options of a task or any other object that visits its keys (engine/session/fields.h): each key by its
// name, with its meaning as a tooltip. Between Window::begin_ui and Window::present, main thread.

#include <filesystem>

#include "engine/session/fields.h"

namespace shvr::ui {

/// Draws the keys and changes the values, each with its name at the left. The path, without suffix, gives new files
/// their names, "/scans/spike": a chooser begins with it; empty: none. Keys that need a form of
/// their own (Fields::other, lists) are left out. Returns whether a chooser of one of them was in front, which Escape
/// then closed.
bool draw_fields(const Fields::Visit& visit, const std::filesystem::path& beside = {});

}  // namespace shvr::ui
