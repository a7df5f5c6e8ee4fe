// Settings of drawings next to the volume: the probe's appearance, aids to find the probe, nodes and internodes.

#include <cmath>

#include <imgui/imgui.h>

#include "engine/workbench/bindings/keymap.h"
#include "engine/workbench/edits/edit.h"
#include "ui/panels/color_field.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// Adds a tooltip that also names the shortcut for the same function.
void explain(const Model& model, const char* shortcut, const std::string& text)
{
    const std::string key = model.keymap.text_of(*shortcut_named(shortcut));
    hint((key.empty() ? text : text + " Key: " + key).c_str());
}

bool flag(const Model& model, const char* name, bool& value, const char* shortcut, const char* text)
{
    const bool is_other = ImGui::Checkbox(name, &value);
    explain(model, shortcut, text);
    return is_other;
}

void shown(const Model& model, Actions& actions)
{
    ViewSettings view = model.session.view;
    bool is_other = flag(model, "Volume", view.volume, "volume",
                         "The volume in three dimensions, painted groups included. Slices show it in any case.");
    ImGui::SameLine();
    is_other |= flag(model, "Nodes, internodes and probe", view.meshes, "meshes",
                     "All solid objects: the trace, surfaces and the probe's ball.");
    if (is_other) set(actions, model, [&](Session& s) { s.view = view; });
}

/// Draws the choice of marks to draw over the picture. The File menu selects whether screenshots contain these marks.
void marks(const Model& model, Actions& actions)
{
    InteractionSettings interaction = model.session.interaction;
    ViewSettings view = model.session.view;
    bool is_other = flag(model, "Scale bar", interaction.scale_bar, "scale_bar",
                         "A length at the lower edge of each picture. Without a spacing it is in voxels.");
    ImGui::SameLine();
    is_other |= flag(model, "Axes", interaction.axes, "axes", "Which way x, y and z go.");
    ImGui::SameLine();
    is_other |= flag(model, "Names of groups", interaction.group_legend, "group_legend",
                     "Painted and traced groups by name and colour.");
    is_other |= flag(model, "Depth and filling at the probe", interaction.probe_label, "probe_label",
                     "Depth of the probe in the structure, and its filled share.");
    const bool has_box = flag(model, "Clip box with handles", view.cut_box, "cut_box",
                              "Edges of the uncut part, and a handle for each of its faces.");
    if (is_other) set(actions, model, [&](Session& s) { s.interaction = interaction; });
    if (has_box) set(actions, model, [&](Session& s) { s.view = view; });
}

void probe_look(const Model& model, Actions& actions)
{
    ProbeSettings probe = model.session.probe;
    bool is_other =
        flag(model, "Silhouette of the probe", probe.silhouette, "silhouette", "Its outline, over whatever hides it.");
    ImGui::SameLine();
    is_other |= flag(model, "Arrow", probe.arrow, "arrow", "Points to the probe where it is out of sight.");
    const uint8_t group = probe.brush.group;
    glm::dvec3 color = probe.color.value_or(group == 0 ? glm::dvec3(0.5) : group_of(model.session.groups, group).color);
    label("Probe's colour");
    if (color_field("##probe's colour", color)) {
        probe.color = color;
        is_other = true;
    }
    hint("The colour of the chosen group, unless you choose one.");
    if (probe.color) {
        ImGui::SameLine();
        if (ImGui::SmallButton("The group's")) {
            probe.color.reset();
            is_other = true;
        }
    }
    is_other |= slider("Probe's opacity", probe.opacity, 0.0, 1.0, "%.2f");
    hint("Opacity of the ball. Below 1 it is see-through, and the picture around it takes twice as long. 0: no ball.");
    if (!resets("probe.opacity", actions) && is_other) set(actions, model, [&](Session& s) { s.probe = probe; });
}

}  // namespace

void aids_panel(const Model& model, Actions& actions)
{
    shown(model, actions);
    marks(model, actions);
    probe_look(model, actions);
}

}  // namespace shvr::ui
