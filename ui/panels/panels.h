#pragma once
// The panels around the graphics window. Each function draws state and returns the user's actions; none changes
// anything but its own widgets. Call between Window::begin_ui and Window::present, main thread.

#include "ui/workbench/action.h"
#include "ui/workbench/model.h"

namespace shvr::ui {

/// The area left for the graphics window, in pixels of the frame buffer.
struct Layout {
    glm::uvec2 begin{0}, end{0};
};

/// The dark, even look of all panels, and a readable font. Call once, before the window is attached, since that uploads
/// the font.
void set_style(double content_scale);

/// Draws the menu bar, side panel, status bar and, if open, the help window; adds to `actions`. Returns the area left.
/// While nothing is open, the start page is there instead of the side panel.
Layout draw_panels(const Model& model, const glm::uvec2& window, Actions& actions);

// The parts of the side panel, each in its own file.
void probe_panel(const Model& model, Actions& actions);
void trace_panel(const Model& model, Actions& actions);
void transfer_function_panel(const Model& model, Actions& actions);
void light_panel(const Model& model, Actions& actions);
void occlusion_panel(const Model& model, Actions& actions);
void views_panel(const Model& model, Actions& actions);
void groups_panel(const Model& model, Actions& actions);
void passes_panel(const Model& model, Actions& actions);
void history_panel(const Model& model, Actions& actions);
void help_window(const Model& model, Actions& actions);
void palette_window(const Model& model, Actions& actions);
void messages_window(const Model& model, Actions& actions);
void menu_bar(const Model& model, Actions& actions);
/// The file chooser, while the model says that it is asked what to open.
void open_dialog(const Model& model, Actions& actions);
/// Whether keys are for a file chooser; and whether one wants another frame, since it is reading a folder.
bool choosers_have_keys();
bool choosers_are_busy();
/// Shows the dialog that asks for another name to go on under, from the next frame on.
void ask_for_name(const Model& model);
void save_as_dialog(Actions& actions);
/// Items of the menu File for exporting, importing, labelling and comparing; and the dialogs that they show.
void task_menu(const Model& model);
/// Shows the dialog that makes a project of that volume, from the next frame on.
void ask_to_import(const std::filesystem::path& volume);
/// Items of the menu File for opening with options and for correcting the spacing; and their dialogs.
void load_menu(const Model& model);
void load_dialogs(const Model& model, Actions& actions);
void task_dialogs(const Model& model, Actions& actions);
/// What goes on beside the work, at the lower left of the graphics window.
void jobs_window(const Model& model, const glm::vec2& lower_left, Actions& actions);
/// What is there while nothing is open.
void start_page(const Model& model, Actions& actions);
void status_bar(const Model& model, const glm::uvec2& window, Actions& actions);
/// That this window only looks, at the upper edge of the graphics window; and the question which files to believe.
void notices(const Model& model, const glm::vec2& begin, float width, Actions& actions);

}  // namespace shvr::ui
