#pragma once
// Draws the forms of figures and movies (engine/workbench/forms). Between Window::begin_ui and Window::present, main
// thread.

#include <string>

#include "engine/workbench/forms/figure_form.h"
#include "engine/workbench/forms/movie_form.h"
#include "ui/panels/dialogs/task_rows.h"

namespace shvr::ui {

/// As in task_rows.h.
bool draw_form(FigureForm& form, const Model& model, const KnownScan& known, bool begins);
bool draw_form(MovieForm& form, const Model& model, const KnownScan& known, bool begins);
std::string about(const FigureForm& form, const Model& model, const KnownScan& known);
std::string about(const MovieForm& form, const Model& model, const KnownScan& known);

/// Draws the button that copies the figure to the clipboard, or names the package that it needs. Returns whether it was
/// pressed. `why`: why no figure can be drawn now; empty: one can.
bool copy_button(const std::string& why);

}  // namespace shvr::ui
