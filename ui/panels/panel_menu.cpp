// Menu items run the bindings of the key table, so that a key and its menu item cannot differ in effect.

#include "ui/panels/panels.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <utility>

#include <imgui/imgui.h>

#include "engine/base/error.h"
#include "engine/workbench/bindings/keymap.h"
#include "engine/workbench/bindings/preferences_file.h"
#include "engine/workbench/bindings/tools.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/edits/group_steps.h"
#include "engine/workbench/lists/bug_report.h"
#include "engine/workbench/models/hand_view.h"
#include "engine/workbench/sight/words.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

constexpr const char* AXES[] = {"x", "y", "z"};

/// Draws shortcuts that act while held as buttons, since choosing a menu item would close the menu at each step.
void held_items(const char* group, const Model& model, Actions& actions)
{
    if (!begin_menu(group, model.is_open)) return;
    ImGui::PushButtonRepeat(true);
    const float width = 11.0f * ImGui::GetFontSize();
    for (const Shortcut& shortcut : shortcuts()) {
        if (std::strcmp(shortcut.group, group) != 0) continue;
        if (ImGui::Button(shortcut.name, {width, 0.0f})) actions.push_back(shortcut.action(model, 1.0));
        ImGui::SameLine();
        ImGui::TextDisabled("%s", model.keymap.text_of(shortcut).c_str());
    }
    ImGui::PopButtonRepeat();
    ImGui::EndMenu();
}

// ---- File and Edit

void file_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("File")) return;
    shortcut_item("open", model, actions);
    if (begin_menu("Open recent", !model.preferences.recent.empty())) {
        for (const std::filesystem::path& path : model.preferences.recent)
            if (ImGui::MenuItem(verbatim(path.string()).c_str())) actions.push_back(Open{path});
        ImGui::EndMenu();
    }
    shortcut_item("open_example", model, actions);
    shortcut_item("save", model, actions);
    shortcut_item("save_as", model, actions);
    shortcut_item("copy_session", model, actions);
    shortcut_item("revert", model, actions);
    ImGui::Separator();
    task_menu(model, actions);
    shortcut_item("load_annotation", model, actions);
    if (model.is_open)
        hint("A mask, offsets, a trace, a transfer function or a mesh, into this scan. Or drop it on the window.");
    ImGui::Separator();
    shortcut_item("figure", model, actions);
    shortcut_item("movie", model, actions);
    shortcut_item("screenshot", model, actions);
    shortcut_item("large_screenshot", model, actions);
    shortcut_item("screenshot_marks", model, actions, model.session.interaction.screenshot_marks);
    ImGui::Separator();
    shortcut_item("quit", model, actions);
    shortcut_item("quit_unsaved", model, actions);
    hint("Files stay as they were last saved. After reopening, undo restores the later changes.");
    ImGui::EndMenu();
}

void edit_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Edit")) return;
    shortcut_item("undo", model, actions);
    shortcut_item("redo", model, actions);
    ImGui::Separator();
    shortcut_item("threshold_group", model, actions);
    if (model.is_open)
        hint("All voxels of a range of intensities, in the whole scan or a box; previewed in the picture.");
    shortcut_item("operate", model, actions);
    ImGui::Separator();
    shortcut_item("preferences", model, actions, model.shows_preferences);
    ImGui::EndMenu();
}

// ---- View

/// Draws the visible range along one axis, in voxels. Both ends of the range can be dragged.
void cut_range(int axis, const Model& model, Actions& actions)
{
    const double size = std::max(double(model.volume.size[axis]), 1.0);
    const CutBox& cut = model.session.cut;
    const double was[2] = {std::clamp(cut.lower[axis], 0.0, size), std::clamp(cut.upper[axis], 0.0, size)};
    double lower = was[0], upper = was[1];
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x, width = 7.0f * ImGui::GetFontSize() - 0.5f * gap;
    ImGui::PushID(axis);
    ImGui::SetNextItemWidth(width);
    if (drag_number("##from", lower, size / 300.0, 0.0, was[1], "from %.0f"))
        actions.push_back(MoveCut{axis, false, (lower - was[0]) / size});
    ImGui::SameLine(0.0f, gap);
    ImGui::SetNextItemWidth(width);
    if (drag_number("##to", upper, size / 300.0, was[0], size, "to %.0f"))
        actions.push_back(MoveCut{axis, true, (upper - was[1]) / size});
    ImGui::SameLine(0.0f, gap);
    ImGui::TextUnformatted(AXES[axis]);
    ImGui::PopID();
}

void cut_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Cutting planes", model.is_open)) return;
    ImGui::TextDisabled("Visible range, in voxels (drag)");
    for (int axis = 0; axis < 3; ++axis) cut_range(axis, model, actions);
    ImGui::Separator();
    shortcut_item("oblique_cut", model, actions);
    shortcut_item("flip_oblique_cut", model, actions);
    shortcut_item("remove_oblique_cut", model, actions);
    shortcut_item("plane_handles", model, actions, model.session.view.plane_handles);
    ImGui::Separator();
    shortcut_item("show_everything", model, actions);
    ImGui::EndMenu();
}

/// Draws the menu item that shows a panel at its usual place, or hides it.
void panel_item(const PanelRow& row, const Model& model, Actions& actions)
{
    const bool is_shown = model.preferences.layout.place_of(row) != PanelPlace::hidden;
    if (ImGui::MenuItem(row.title, nullptr, is_shown, model.is_open)) {
        const PanelPlace next = is_shown ? PanelPlace::hidden : PanelPlace::side;
        actions.push_back(Prefer{patch_of_panel(row.id, {.place = next})});
        if (next == PanelPlace::side && !model.preferences.layout.shows_side)
            actions.push_back(Prefer{R"({"layout":{"shows_side":true}})"});
    }
    hint(row.hint);
}

void panels_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Panels")) return;
    for (const PanelRow& row : panel_rows()) panel_item(row, model, actions);
    ImGui::Separator();
    shortcut_item("side_panels", model, actions, model.preferences.layout.shows_side);
    shortcut_item("tool_bar", model, actions, model.preferences.layout.shows_tool_bar);
    shortcut_item("reset_layout", model, actions);
    shortcut_item("focus_panels", model, actions);
    ImGui::EndMenu();
}

void view_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("View")) return;
    if (begin_menu("Look from", model.is_open)) {
        for (const std::string& camera : camera_names(model.session))
            if (ImGui::MenuItem(verbatim(camera).c_str())) actions.push_back(LookFrom{camera});
        ImGui::EndMenu();
    }
    kept_views_menu(model, actions);
    looks_menu(model, actions);
    const Arrangement arrangement = model.session.view.arrangement;
    shortcut_item("single_view", model, actions, arrangement == Arrangement::single);
    shortcut_item("stereo", model, actions, arrangement == Arrangement::stereo);
    shortcut_item("overview", model, actions, arrangement == Arrangement::overview);
    shortcut_item("slices", model, actions, arrangement == Arrangement::slices);
    shortcut_item("full_screen", model, actions, model.is_full_screen);
    panels_menu(model, actions);
    ImGui::Separator();
    shortcut_item("fit_view", model, actions);
    shortcut_item("reset_view", model, actions);
    shortcut_item("look_at_selection", model, actions);
    sight_items(model, actions);
    ImGui::Separator();
    shortcut_item("volume", model, actions, model.session.view.volume);
    shortcut_item("meshes", model, actions, model.session.view.meshes);
    shortcut_item("cut_box", model, actions, model.session.view.cut_box);
    ImGui::Separator();
    held_items("Turn the view", model, actions);
    held_items("Move the view", model, actions);
    ImGui::Separator();
    shortcut_item("shading", model, actions, model.session.light.shaded);
    shortcut_item("update_occlusion", model, actions);
    held_items("Distance blending", model, actions);
    cut_menu(model, actions);
    held_items("Clip planes", model, actions);
    ImGui::EndMenu();
}

// ---- Paint, Probe and Help

/// Returns the keys of the shortcut named `prefix` and the group's number; the first groups have such shortcuts.
std::string keys_of(const char* prefix, uint8_t group, const Model& model)
{
    const Shortcut* const shortcut = shortcut_named(sentence(prefix, int(group)));
    return shortcut ? model.keymap.text_of(*shortcut) : std::string();
}

void brush_item(const BrushRow& row, const Model& model, Actions& actions)
{
    if (!ImGui::MenuItem(row.title, nullptr, model.brush().brush == row.brush)) return;
    BrushSettings changed = model.brush();
    changed.brush = row.brush;
    set(actions, model, [&](Session& s) { s.probe.brush = changed; });
}

void paint_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Paint", model.is_open)) return;
    for (const BrushRow& row : BRUSHES) brush_item(row, model, actions);
    shortcut_item("next_brush", model, actions);
    shortcut_item("threshold_here", model, actions);
    ImGui::Separator();
    shortcut_item("tool_paint", model, actions, model.tool() == Tool::paint);
    shortcut_item("tool_erase", model, actions, model.tool() == Tool::erase);
    ImGui::Separator();
    for (const uint8_t group : known_groups(model)) {
        const std::string label =
            sentence(int(group), "  ", verbatim(group_of(model.session.groups, group).name), "##", int(group));
        if (ImGui::MenuItem(label.c_str(), keys_of("group_", group, model).c_str(), model.brush().group == group))
            set(actions, model, [&](Session& s) { s.probe.brush.group = group; });
    }
    shortcut_item("eraser", model, actions, model.brush().group == 0);
    shortcut_item("next_group", model, actions);
    shortcut_item("previous_group", model, actions);
    shortcut_item("new_group", model, actions);
    ImGui::Separator();
    shortcut_item("preview", model, actions, model.session.probe.previews());
    ImGui::EndMenu();
}

void trace_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Trace", model.is_open)) return;
    const TraceSelection& selected = model.trace.selection();
    shortcut_item("tool_trace", model, actions, model.tool() == Tool::trace);
    shortcut_item("tool_select", model, actions, model.tool() == Tool::select);
    shortcut_item("next_tool", model, actions);
    ImGui::Separator();
    shortcut_item("add_node", model, actions);
    shortcut_item("select_nearest", model, actions);
    shortcut_item("select_segment", model, actions);
    shortcut_item("deselect", model, actions);
    ImGui::Separator();
    shortcut_item("link_nearest", model, actions);
    shortcut_item("delete_selected", model, actions);
    shortcut_item("mend_cut", model, actions);
    shortcut_item("next_node", model, actions);
    shortcut_item("previous_node", model, actions);
    shortcut_item("centered_nodes", model, actions, model.session.probe.centered_nodes);
    shortcut_item("measured_radius", model, actions, model.session.probe.measured_radius);
    ImGui::Separator();
    shortcut_item("larger_selected", model, actions);
    shortcut_item("smaller_selected", model, actions);
    shortcut_item("larger_nodes", model, actions);
    shortcut_item("smaller_nodes", model, actions);
    if (begin_menu("Group of the selection", !selected.empty())) {
        for (const uint8_t group : known_groups(model)) {
            const std::string label =
                sentence(int(group), "  ", verbatim(group_of(model.session.groups, group).name), "##", int(group));
            if (ImGui::MenuItem(label.c_str(), keys_of("regroup_", group, model).c_str()))
                actions.push_back(GroupOp{group});
        }
        ImGui::EndMenu();
    }
    ImGui::EndMenu();
}

void hand_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Touch")) return;
    const FeelSettings& touch = model.session.probe.touch;
    shortcut_item("next_mode", model, actions);
    shortcut_item("let_go", model, actions, model.hand && model.hand->is_let_go);
    shortcut_item("stronger", model, actions);
    shortcut_item("weaker", model, actions);
    ImGui::Separator();
    shortcut_item("at_proxy", model, actions, touch.at_proxy);
    shortcut_item("overlap_radius", model, actions, touch.overlap_radius);
    shortcut_item("to_nodes", model, actions, touch.to_nodes);
    shortcut_item("to_lines", model, actions, touch.to_lines);
    shortcut_item("feels_hidden", model, actions, touch.feels_hidden);
    shortcut_item("clicks", model, actions, touch.clicks);
    shortcut_item("next_plane", model, actions);
    ImGui::Separator();
    shortcut_item("find_devices", model, actions);
    shortcut_item("record_stylus", model, actions, model.hand && model.hand->recorded_s);
    ImGui::EndMenu();
}

void probe_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Probe", model.is_open)) return;
    shortcut_item("probe_onto", model, actions);
    shortcut_item("guide", model, actions, model.session.probe.guided);
    shortcut_item("next_guidance", model, actions);
    hand_menu(model, actions);
    shortcut_item("shell", model, actions, model.session.probe.shell);
    shortcut_item("silhouette", model, actions, model.session.probe.silhouette);
    shortcut_item("arrow", model, actions, model.session.probe.arrow);
    ImGui::Separator();
    shortcut_item("larger_workspace", model, actions);
    shortcut_item("smaller_workspace", model, actions);
    shortcut_item("larger_probe", model, actions);
    shortcut_item("smaller_probe", model, actions);
    ImGui::EndMenu();
}

void tools_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Tools")) return;
    shortcut_item("tool_turn", model, actions, model.tool() == Tool::turn);
    shortcut_item("tool_measure", model, actions, model.tool() == Tool::measure);
    shortcut_item("next_measure", model, actions);
    shortcut_item("end_measure", model, actions);
    shortcut_item("take_back_point", model, actions);
    shortcut_item("copy_measurements", model, actions);
    shortcut_item("clear_measurements", model, actions);
    ImGui::Separator();
    shortcut_item("palette", model, actions);
    ImGui::Separator();
    shortcut_item("passes", model, actions, model.shows_passes);
    ImGui::EndMenu();
}

void help_menu(const Model& model, Actions& actions)
{
    if (!begin_menu("Help")) return;
    shortcut_item("manual", model, actions);
    shortcut_item("help", model, actions, model.shows_help);
    shortcut_item("focus_menu", model, actions);
    shortcut_item("messages", model, actions, model.shows_messages);
    ImGui::EndMenu();
}

// ---- Status

std::string reading_of(const Model& model)
{
    const uint8_t group = model.reading.group;
    return in_words(model.reading, model.volume, group > 0 ? group_of(model.session.groups, group).name : "");
}

/// Lists the parts that are hidden in the picture, so that the user knows why they are missing.
std::string hidden_in_words(const Model& model)
{
    const ViewSettings& view = model.session.view;
    std::string words;
    const auto add = [&](const char* what, const char* shortcut) {
        const std::string key = model.keymap.text_of(*shortcut_named(shortcut));
        words += (words.empty() ? "" : ", ") + std::string(what) + (key.empty() ? "" : " (" + key + ")");
    };
    if (!view.volume) add("no volume", "volume");
    if (!view.meshes) add("no nodes", "meshes");
    if (view.solo) words += (words.empty() ? "only group " : ", only group ") + std::to_string(*view.solo);
    return words.empty() ? words : words + "    |    ";
}

void align_right(const std::string& text)
{
    const float width = ImGui::CalcTextSize(text.c_str()).x;
    ImGui::SameLine();
    ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(), ImGui::GetContentRegionMax().x - width));
    ImGui::TextUnformatted(text.c_str());
}

/// Draws the last message, and the number of unread errors and warnings. A click shows all messages.
void said(const Model& model, const std::string& right, Actions& actions)
{
    const std::string unread = unread_in_words(model.messages);
    const float gap = 2.0f * ImGui::GetFontSize(), begin = ImGui::GetCursorPosX(), top = ImGui::GetCursorPosY();
    const float end =
        ImGui::GetContentRegionMax().x - (right.empty() ? 0.0f : ImGui::CalcTextSize(right.c_str()).x + gap);
    const float unread_at = end - ImGui::CalcTextSize(unread.c_str()).x;
    const bool is_bad = !model.messages.all().empty() && model.messages.all().back().weight == Weight::error;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = std::max((unread.empty() ? end : unread_at - gap) - begin, 1.0f);
    ImGui::PushClipRect(at, {at.x + width, at.y + ImGui::GetFrameHeight()}, true);
    ImGui::PushStyleColor(ImGuiCol_Text, is_bad ? ImU32(ERROR_TEXT) : ImGui::GetColorU32(ImGuiCol_Text));
    const std::string whole = sentence(is_bad ? "Error: " : "", model.status());
    const bool fits = ImGui::CalcTextSize(whole.c_str()).x <= width;
    ImGui::TextUnformatted(fits ? whole.c_str() : shortened(without_folders(whole), width).c_str());
    ImGui::PopStyleColor();
    bool is_clicked = ImGui::IsItemClicked();
    hint(fits ? "A click shows all messages." : (whole + "\n\nA click shows all messages.").c_str());
    ImGui::PopClipRect();
    if (!unread.empty()) {
        ImGui::SetCursorPos({unread_at, top});
        ImGui::PushStyleColor(ImGuiCol_Text, WARNING);
        ImGui::TextUnformatted(unread.c_str());
        ImGui::PopStyleColor();
        is_clicked |= ImGui::IsItemClicked();
        hint("Unread messages. Click to show all.");
    }
    if (is_clicked) actions.push_back(ShowMessages{});
    ImGui::SetCursorPos({begin, top});
    ImGui::Dummy({0.0f, 0.0f});
}

}  // namespace

void shortcut_item(const char* id, const Model& model, Actions& actions, bool is_checked)
{
    const Shortcut* const shortcut = shortcut_named(id);
    SHVR_CHECK(shortcut, id);
    const std::string why = why_not(model, *shortcut);
    if (ImGui::MenuItem(shortcut->name, model.keymap.text_of(*shortcut).c_str(), is_checked, why.empty()))
        actions.push_back(shortcut->action(model, 1.0));
    if (!why.empty() && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", why.c_str());
}

void menu_bar(const Model& model, Actions& actions)
{
    if (ImGui::BeginMainMenuBar()) {
        file_menu(model, actions);
        edit_menu(model, actions);
        view_menu(model, actions);
        paint_menu(model, actions);
        trace_menu(model, actions);
        probe_menu(model, actions);
        tools_menu(model, actions);
        help_menu(model, actions);
        close_menus_by_escape();
        ImGui::EndMainMenuBar();
    }
    open_dialog(model, actions);
    name_and_take_dialogs(model, actions);
    task_dialogs(model, actions);
    keep_look_dialog(model, actions);
    operations_window(model, actions);
}

void status_bar(const Model& model, const glm::uvec2& window, Actions& actions)
{
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    const float width = float(window.x) / (scale.x > 0.0f ? scale.x : 1.0f);
    const float bottom = float(window.y) / (scale.y > 0.0f ? scale.y : 1.0f);
    const float height = ImGui::GetFrameHeight();
    const ImVec2 padding{ImGui::GetStyle().WindowPadding.x, ImGui::GetStyle().FramePadding.y};
    ImGui::SetNextWindowPos({0.0f, bottom - height});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1.0f, 1.0f});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ImGui::GetStyleColorVec4(ImGuiCol_MenuBarBg));
    ImGui::Begin("Status", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoNav);
    const std::string right = !model.is_open ? std::string()
                                             : hidden_in_words(model) + reading_of(model) + "    |    " +
                                                   saved_in_words(model) + "    |    " +
                                                   (!model.view_is_complete ? "refining"
                                                    : model.view_is_limited ? "coarser than the screen: device budget"
                                                                            : "sharp");
    said(model, right, actions);
    align_right(right);
    ImGui::End();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar(4);
}

}  // namespace shvr::ui
