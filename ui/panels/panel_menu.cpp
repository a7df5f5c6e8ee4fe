// Menus run the bindings of the key table, so that a key and its menu item cannot differ.

#include "ui/panels/panels.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <utility>

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "engine/base/error.h"
#include "ui/keys.h"

namespace shvr::ui {

namespace {

constexpr const char* AXES[] = {"x", "y", "z"};
constexpr const char* OPEN_TITLE = "Open a volume or a session";

const KeyBinding& binding_named(const char* name)
{
    const auto bindings = key_bindings();
    const auto found = std::find_if(bindings.begin(), bindings.end(),
                                    [&](const KeyBinding& binding) { return std::strcmp(binding.name, name) == 0; });
    SHVR_CHECK(found != bindings.end(), name);
    return *found;
}

struct ItemState {
    bool is_checked = false;
    bool is_enabled = true;
};

/// The menu item of a key binding.
void key_item(const char* name, const Model& model, Actions& actions, const ItemState& state = {})
{
    const KeyBinding& binding = binding_named(name);
    if (ImGui::MenuItem(name, name_of(binding).c_str(), state.is_checked, state.is_enabled))
        actions.push_back(binding.action(model, 1.0));
}

/// Keys that act while held are buttons here, since an item would close the menu at every step.
void key_buttons(const char* group, const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu(group)) return;
    ImGui::PushButtonRepeat(true);
    const float width = 11.0f * ImGui::GetFontSize();
    for (const KeyBinding& binding : key_bindings()) {
        if (std::strcmp(binding.group, group) != 0) continue;
        if (ImGui::Button(binding.name, {width, 0.0f})) actions.push_back(binding.action(model, 1.0));
        ImGui::SameLine();
        ImGui::TextDisabled("%s", name_of(binding).c_str());
    }
    ImGui::PopButtonRepeat();
    ImGui::EndMenu();
}

// ---- File and Edit

struct OpenDialog {
    bool is_asked_for = false;
    std::string path;
};

void file_menu(OpenDialog& dialog, const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu("File")) return;
    if (ImGui::MenuItem("Open...")) dialog.is_asked_for = true;
    key_item("Save", model, actions);
    key_item("Screenshot", model, actions);
    key_item("Large screenshot", model, actions);
    ImGui::Separator();
    key_item("Quit", model, actions);
    ImGui::EndMenu();
}

/// Call outside the menu, which is closed while this is open.
void open_dialog(OpenDialog& dialog, Actions& actions)
{
    if (dialog.is_asked_for) ImGui::OpenPopup(OPEN_TITLE);
    const bool appears = std::exchange(dialog.is_asked_for, false);
    ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Appearing, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(OPEN_TITLE, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
    ImGui::TextUnformatted("Path of a volume, a session (.json) or a project folder:");
    ImGui::SetNextItemWidth(36.0f * ImGui::GetFontSize());
    if (appears) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputText("##path", &dialog.path,
                                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    ImGui::TextDisabled("A file can also be dropped onto the window.");
    const ImVec2 button{6.0f * ImGui::GetFontSize(), 0.0f};
    ImGui::BeginDisabled(dialog.path.empty());
    const bool accepted = (ImGui::Button("Open", button) || entered) && !dialog.path.empty();
    ImGui::EndDisabled();
    ImGui::SameLine();
    const bool cancelled = ImGui::Button("Cancel", button) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    if (accepted) actions.push_back(Open{dialog.path});
    if (accepted || cancelled) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

void edit_menu(const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu("Edit")) return;
    key_item("Undo", model, actions, {.is_enabled = model.undoable > 0});
    key_item("Redo", model, actions, {.is_enabled = model.redoable > 0});
    ImGui::EndMenu();
}

// ---- View

/// The visible range along one axis, in voxels; both ends can be dragged.
void cut_range(int axis, const Model& model, Actions& actions)
{
    const double size = std::max(double(model.volume.size[axis]), 1.0);
    const CutBox& cut = model.session.cut;
    const double was[2] = {std::clamp(cut.lower[axis], 0.0, size), std::clamp(cut.upper[axis], 0.0, size)};
    float lower = float(was[0]), upper = float(was[1]);
    ImGui::SetNextItemWidth(14.0f * ImGui::GetFontSize());
    const bool changed = ImGui::DragFloatRange2(AXES[axis], &lower, &upper, float(size / 300.0), 0.0f, float(size),
                                                "from %.0f", "to %.0f", ImGuiSliderFlags_AlwaysClamp);
    if (!changed) return;
    if (double(lower) != was[0]) actions.push_back(MoveCut{axis, false, (double(lower) - was[0]) / size});
    if (double(upper) != was[1]) actions.push_back(MoveCut{axis, true, (double(upper) - was[1]) / size});
}

void cut_menu(const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu("Cutting planes")) return;
    ImGui::TextDisabled("What is drawn, in voxels (drag)");
    for (int axis = 0; axis < 3; ++axis) cut_range(axis, model, actions);
    ImGui::Separator();
    if (ImGui::MenuItem("Show everything")) actions.push_back(ResetCuts{});
    ImGui::EndMenu();
}

void view_menu(const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu("View")) return;
    if (ImGui::BeginMenu("Look from", !model.cameras.empty())) {
        for (const std::string& camera : model.cameras)
            if (ImGui::MenuItem(camera.c_str())) actions.push_back(LookFrom{camera});
        ImGui::EndMenu();
    }
    const Arrangement arrangement = model.session.view.arrangement;
    key_item("Full screen", model, actions, {.is_checked = arrangement == Arrangement::single});
    key_item("Two eyes", model, actions, {.is_checked = arrangement == Arrangement::stereo});
    key_item("Overview", model, actions, {.is_checked = arrangement == Arrangement::overview});
    key_item("Slices", model, actions, {.is_checked = arrangement == Arrangement::slices});
    ImGui::Separator();
    key_buttons("Turn the view", model, actions);
    key_buttons("Move the view", model, actions);
    ImGui::Separator();
    Light light = model.session.light;
    if (ImGui::MenuItem("Shading", nullptr, &light.shaded)) actions.push_back(SetLight{light});
    const OcclusionSettings& occlusion = model.session.light.occlusion;
    key_item("Update ambient occlusion", model, actions,
             {.is_enabled = light.shaded && occlusion.strength > 0.0 && !occlusion.automatic});
    key_buttons("Distance blending", model, actions);
    cut_menu(model, actions);
    key_buttons("Clip planes", model, actions);
    ImGui::EndMenu();
}

// ---- Paint, Probe and Help

void brush_item(const BrushRow& row, const Model& model, Actions& actions)
{
    if (!ImGui::MenuItem(row.title, nullptr, model.brush().brush == row.brush)) return;
    BrushSettings changed = model.brush();
    changed.brush = row.brush;
    actions.push_back(SetBrush{changed});
}

void paint_menu(const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu("Paint")) return;
    for (const BrushRow& row : BRUSHES) brush_item(row, model, actions);
    key_item("Next brush", model, actions);
    ImGui::Separator();
    for (int group = 1; group <= 9; ++group) {
        const std::string name = group_of(model.session.groups, uint8_t(group)).name;
        const std::string label = name + "##" + std::to_string(group);
        if (ImGui::MenuItem(label.c_str(), std::to_string(group).c_str(), int{model.brush().group} == group))
            actions.push_back(ChooseGroup{uint8_t(group)});
    }
    key_item("Eraser", model, actions, {.is_checked = model.brush().group == 0});
    ImGui::Separator();
    key_item("Preview of the brush", model, actions, {.is_checked = model.session.probe.preview});
    ImGui::EndMenu();
}

void trace_menu(const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu("Trace")) return;
    const TraceSelection& selected = model.trace.selection();
    const bool has_nodes = !model.trace.nodes().empty();
    key_item("Paint or trace", model, actions, {.is_checked = model.tool == Tool::trace});
    ImGui::Separator();
    key_item("Add a node, linked with the selected one", model, actions);
    key_item("Select the nearest node, then its internode", model, actions, {.is_enabled = has_nodes});
    key_item("Select the whole segment", model, actions, {.is_enabled = !selected.empty()});
    key_item("Deselect", model, actions, {.is_enabled = !selected.empty()});
    ImGui::Separator();
    key_item("Link the selected node with the nearest", model, actions, {.is_enabled = selected.node().has_value()});
    key_item("Delete what is selected", model, actions, {.is_enabled = !selected.empty()});
    ImGui::Separator();
    key_item("Larger selected nodes, or internodes of the group", model, actions, {.is_enabled = has_nodes});
    key_item("Smaller selected nodes, or internodes of the group", model, actions, {.is_enabled = has_nodes});
    key_item("Larger nodes of the group", model, actions, {.is_enabled = has_nodes});
    key_item("Smaller nodes of the group", model, actions, {.is_enabled = has_nodes});
    if (ImGui::BeginMenu("Group of what is selected", !selected.empty())) {
        for (int group = 1; group <= 9; ++group) {
            const std::string label =
                group_of(model.session.groups, uint8_t(group)).name + "##" + std::to_string(group);
            if (ImGui::MenuItem(label.c_str(), ("Ctrl + " + std::to_string(group)).c_str()))
                actions.push_back(Trace{GroupOp{uint8_t(group)}});
        }
        ImGui::EndMenu();
    }
    ImGui::EndMenu();
}

void probe_menu(const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu("Probe")) return;
    key_item("Guide the probe", model, actions, {.is_checked = model.assistance});
    key_item("Next kind of guidance", model, actions);
    key_item("Iso-surface around the probe", model, actions, {.is_checked = model.session.probe.shell});
    ImGui::Separator();
    key_item("Larger probe", model, actions);
    key_item("Smaller probe", model, actions);
    ImGui::EndMenu();
}

void help_menu(const Model& model, Actions& actions)
{
    if (!ImGui::BeginMenu("Help")) return;
    key_item("Keys and mouse", model, actions, {.is_checked = model.shows_help});
    ImGui::EndMenu();
}

// ---- Status

std::string place_of(const glm::dvec3& voxel)
{
    char text[96];
    std::snprintf(text, sizeof text, "probe at voxel %.1f, %.1f, %.1f", voxel.x, voxel.y, voxel.z);
    return text;
}

void align_right(const std::string& text)
{
    const float width = ImGui::CalcTextSize(text.c_str()).x;
    ImGui::SameLine();
    ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(), ImGui::GetContentRegionMax().x - width));
    ImGui::TextUnformatted(text.c_str());
}

}  // namespace

void menu_bar(const Model& model, Actions& actions)
{
    static OpenDialog dialog;
    if (ImGui::BeginMainMenuBar()) {
        file_menu(dialog, model, actions);
        edit_menu(model, actions);
        view_menu(model, actions);
        paint_menu(model, actions);
        trace_menu(model, actions);
        probe_menu(model, actions);
        help_menu(model, actions);
        ImGui::EndMainMenuBar();
    }
    open_dialog(dialog, actions);
}

void status_bar(const Model& model, const glm::uvec2& window)
{
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    const float width = float(window.x) / (scale.x > 0.0f ? scale.x : 1.0f);
    const float bottom = float(window.y) / (scale.y > 0.0f ? scale.y : 1.0f);
    const float height = ImGui::GetFrameHeight();
    const ImVec2 padding{ImGui::GetStyle().WindowPadding.x, ImGui::GetStyle().FramePadding.y};
    ImGui::SetNextWindowPos({0.0f, bottom - height});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1.0f, 1.0f});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, ImGui::GetStyleColorVec4(ImGuiCol_MenuBarBg));
    ImGui::Begin("Status", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoNav);
    ImGui::TextUnformatted(model.status.c_str());
    align_right(place_of(model.probe_voxel) + "    |    " + (model.is_saved ? "saved" : "not saved") + "    |    " +
                (!model.view_is_complete ? "refining"
                 : model.view_is_limited ? "coarser than the screen: device budget"
                                         : "sharp"));
    ImGui::End();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar(3);
}

}  // namespace shvr::ui
