#pragma once
// What is drawn beside and around the graphics window. Each function draws state and returns what the person asked for;
// none changes anything but its own widgets. Called between Window::begin_ui and Window::present, main thread.

#include "ui/action.h"
#include "ui/model.h"

namespace shvr::ui {

/// Where the graphics window is left free, in pixels of the frame buffer.
struct Layout {
    glm::uvec2 begin{0}, end{0};
};

/// The dark, even look of all panels, and a readable font. Once, before the window is attached: that takes the font
/// along.
void set_style(double content_scale);

/// Menu bar, side panel, status bar and, when asked for, the help window; adds to `actions`. Returns what is left.
Layout draw_panels(const Model& model, const glm::uvec2& window, Actions& actions);

// The parts of the side panel, each in a file of its own.
void probe_panel(const Model& model, Actions& actions);
void trace_panel(const Model& model, Actions& actions);
void transfer_function_panel(const Model& model, Actions& actions);
void light_panel(const Model& model, Actions& actions);
void occlusion_panel(const Model& model, Actions& actions);
void views_panel(const Model& model, Actions& actions);
void groups_panel(const Model& model, Actions& actions);
void passes_panel(const Model& model, Actions& actions);
void help_window(const Model& model, Actions& actions);
void menu_bar(const Model& model, Actions& actions);
void status_bar(const Model& model, const glm::uvec2& window);

}  // namespace shvr::ui
