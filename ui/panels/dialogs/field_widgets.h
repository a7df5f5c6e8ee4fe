#pragma once
// Widgets for the options of a task, or for any other object that visits its keys (engine/session/fields.h): each key
// is shown by its name, with its meaning as a tooltip. Between Window::begin_ui and Window::present, main thread.

#include <filesystem>
#include <span>
#include <string_view>

#include "engine/session/fields.h"

namespace shvr::ui {

/// Draws the keys, each with its name at the left, and changes their values. The path, without suffix ("/scans/spike"),
/// is where choosers begin and from which they form the names of new files; empty: none. Keys that need a form of their
/// own (Fields::other, lists) are left out. Returns whether a chooser of one of the keys was in front: an Escape then
/// closed that chooser. `begins`: gives the keyboard to the first path, with all text typed from now on.
/// `left_out`: keys that the dialog draws in rows of its own.
bool draw_fields(const Fields::Visit& visit, const std::filesystem::path& beside = {}, bool begins = false,
                 std::span<const std::string_view> left_out = {});

/// Draws a name at the left, for the widgets that follow it; the first of them takes the width of a value. In a narrow
/// window the name is above them.
void field_name(const char* name);
/// Returns that width, in pixels, or what is left of the row if that is less. `fonts`: in font sizes.
float width_of_value(float fonts);
/// Puts the next widget, of that width in pixels, to the right of the one before it, or below it if there is no room.
void beside_or_below(float width);
void button_beside_or_below(const char* label);
/// Draws a row with a path to be typed, and a button for the chooser, which begins at `begin` while nothing is typed.
/// `begins`: gives the keyboard to the field, which then shows `path`, with all text typed from now on. Returns whether
/// it was changed.
bool path_row(const char* name, std::string& path, const char* meaning, const std::filesystem::path& begin,
              bool begins = false);
/// Returns whether the chooser of a path is in front.
bool path_chooser_is_open();

/// Call before the Begin of a dialog with rows: gives it a width that holds them, at most `share` of the screen's.
void size_dialog(float share = 1.0f);
/// Moves the present window up if it has grown beyond a height of the screen, as by more rows. Inside the window.
void keep_above(float lower_edge);
/// Draws the heading More; returns whether what is below it is shown.
bool more_heading();
/// Draws what a dialog says below its rows: `failure` in the colour of warnings instead of `about`, if there is one.
void dialog_note(const std::string& about, const std::string& failure);

/// Returns whether Enter was pressed in a dialog that is in front, which confirms the dialog.
bool enter_confirms();

}  // namespace shvr::ui
