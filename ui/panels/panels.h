#pragma once
// The panels around the graphics window. Each function draws the given state and returns the user's actions; it changes
// nothing except its own widgets. Call between Window::begin_ui and Window::present, main thread.

#include <string_view>

#include <imgui/imgui.h>

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"

namespace shvr::ui {

/// The area that the panels leave for the graphics window, in pixels of the frame buffer.
struct Layout {
    glm::uvec2 begin{0}, end{0};
};

/// Name of the window that holds the side panels, for code that gives it the keyboard.
inline constexpr const char* SIDE_PANEL = "Side panel";

/// Returns whether a window of the interface covered the position `at` in the last frame, in units of the interface.
bool covers(const glm::dvec2& at);

/// Draws menu bar, tool bar, panels, status bar and the windows that are shown; appends the user's actions to
/// `actions`. Returns the area left. While nothing is open, the start page replaces tools and panels.
Layout draw_panels(const Model& model, const glm::uvec2& window, Actions& actions);

// Draw the panels' contents, each in its own file; engine/workbench/appearance/panel_rows.h has their titles and order.
void transfer_function_panel(const Model& model, Actions& actions);
void groups_panel(const Model& model, Actions& actions);
void probe_panel(const Model& model, Actions& actions);
void touch_panel(const Model& model, Actions& actions);
void trace_panel(const Model& model, Actions& actions);
void trace_list_panel(const Model& model, Actions& actions);
void measurements_panel(const Model& model, Actions& actions);
void meshes_panel(const Model& model, Actions& actions);
void light_panel(const Model& model, Actions& actions);
void occlusion_panel(const Model& model, Actions& actions);
void cuts_panel(const Model& model, Actions& actions);
void quality_panel(const Model& model, Actions& actions);
void aids_panel(const Model& model, Actions& actions);
void views_panel(const Model& model, Actions& actions);
void history_panel(const Model& model, Actions& actions);
struct PanelBody {
    std::string_view id;  ///< as in panel_rows.h
    void (*draw)(const Model& model, Actions& actions) = nullptr;
};
inline constexpr PanelBody PANEL_BODIES[] = {
    {"transfer_function", transfer_function_panel},
    {"groups", groups_panel},
    {"probe", probe_panel},
    {"touch", touch_panel},
    {"trace", trace_panel},
    {"trace_list", trace_list_panel},
    {"measurements", measurements_panel},
    {"meshes", meshes_panel},
    {"light", light_panel},
    {"occlusion", occlusion_panel},
    {"cuts", cuts_panel},
    {"quality", quality_panel},
    {"aids", aids_panel},
    {"views", views_panel},
    {"history", history_panel},
};

/// Draws, within the touch panel, the connected devices and the state of the device in use.
void device_section(const Model& model, Actions& actions);
/// Draws device time per pass of a picture, in a window of its own.
void passes_window(const Model& model, Actions& actions);
/// Draws, below the menu and over the whole width, the tools, the active group and the functions of the mouse buttons.
float tool_bar_height();
void tool_bar(const ImVec2& at, float width, const Model& model, Actions& actions);
/// Call before Begin: puts a window at its last position (layout.h) or, the first time, in the middle, with the usual
/// size in font sizes.
void place_kept_window(const char* id, const glm::dvec2& usual_size, const Model& model);
/// Call after Begin: stores the window's position and size when the mouse is released.
void keep_window(const char* id, const Model& model, Actions& actions);
/// The same for a window whose size follows its contents. The first time, its lower right corner is at `first`; it is
/// stored where it was dragged to, not where it moves as it grows.
void place_kept_corner(const char* id, const glm::vec2& first, const Model& model);
void keep_corner(const char* id, Actions& actions);
/// Draws the hints of the first start over that width of the side panel, until they are dismissed. Returns the height.
float first_hints(const Model& model, const ImVec2& begin, float width, Actions& actions);
void preferences_window(const Model& model, Actions& actions);
void help_window(const Model& model, Actions& actions);
void palette_window(const Model& model, Actions& actions);
void messages_window(const Model& model, Actions& actions);
void menu_bar(const Model& model, Actions& actions);
/// Draws the menu item of a shortcut. While the action is unavailable, the item is grey and states the reason.
void shortcut_item(const char* id, const Model& model, Actions& actions, bool is_checked = false);
/// Draws items of the View menu: stored views, the pivot of rotation, drawings over pictures.
void kept_views_menu(const Model& model, Actions& actions);
void sight_items(const Model& model, Actions& actions);
/// Draws, within the trace panel, the settings for the radius of new nodes.
void new_nodes(const Model& model, Actions& actions);
/// Shows the file chooser while the model requests it.
void open_dialog(const Model& model, Actions& actions);
/// Return whether keys go to a file chooser, and whether a file chooser or a dialog needs another frame because it is
/// waiting: for the disk, or for values to rest.
bool choosers_have_keys();
bool choosers_are_busy();
/// Asks for the scan to which the open label image belongs, opens that, and loads the label image into it.
void ask_for_scan_of_labels(const Model& model);
/// Asks for the session file on this machine that is to keep annotation of the open volume at an address.
void ask_for_session_of_remote(const Model& model);
/// Draws the dialog that loads annotation: the file, what it is, and what loading it would change.
void load_preview_dialog(const Model& model, Actions& actions);
/// Returns whether that dialog, as last drawn, waits for the disk.
bool load_dialog_waits();
/// Draws the dialogs for saving under another name and for loading annotation.
void name_and_take_dialogs(const Model& model, Actions& actions);
/// Draws items of the menu File for exporting, importing, labelling and comparing; and their dialogs.
void task_menu(const Model& model, Actions& actions);
/// Returns whether a dialog of a task, as last drawn, waits for the disk.
bool task_dialog_waits();
/// Shows the dialog that makes a project of that volume, from the next frame on.
void ask_to_import(const std::filesystem::path& volume, Actions& actions);
/// Draws the window in which an operation on groups is chosen, previewed and carried out.
void operations_window(const Model& model, Actions& actions);
/// Returns whether that window, as last drawn, starts a preview once its values have rested.
bool operations_window_waits();
/// Draws the menu of looks, and the dialog that saves one.
void looks_menu(const Model& model, Actions& actions);
void keep_look_dialog(const Model& model, Actions& actions);
/// Draws the dialogs for opening with options and for correcting the spacing.
void load_dialogs(const Model& model, Actions& actions);
void task_dialogs(const Model& model, Actions& actions);
/// Draws the list of background jobs, centred, with its lower edge at `lower_middle`.
void jobs_window(const Model& model, const glm::vec2& lower_middle, Actions& actions);
/// Draws the page shown while nothing is open.
void start_page(const Model& model, Actions& actions);
void status_bar(const Model& model, const glm::uvec2& window, Actions& actions);
/// Draws the read-only notice at the upper edge of the graphics window, and the question which files to trust. Returns
/// the total height of both.
float notices(const Model& model, const glm::vec2& begin, float width, Actions& actions);

}  // namespace shvr::ui
