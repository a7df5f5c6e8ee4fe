#pragma once
// Widgets for the options of a task, or for any other object that visits its keys (engine/session/fields.h): each key
// is shown by its name, with its meaning as a tooltip. Between Window::begin_ui and Window::present, main thread.

#include <filesystem>

#include "engine/session/fields.h"

namespace shvr::ui {

/// Draws the keys, each with its name at the left, and changes their values. The path parameter, without suffix
/// ("/scans/spike"), is where choosers begin and from which they form the names of new files; empty: none. Keys that
/// need a form of their own (Fields::other, lists) are omitted. Returns whether a chooser of one of the keys was in
/// front; an Escape then closed it. `begins`: gives the keyboard to the first path, with all text typed from now on.
bool draw_fields(const Fields::Visit& visit, const std::filesystem::path& beside = {}, bool begins = false);

/// Returns whether Enter was pressed in a dialog that is in front, which confirms the dialog.
bool enter_confirms();

}  // namespace shvr::ui
