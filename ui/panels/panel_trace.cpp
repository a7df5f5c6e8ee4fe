// Tracing: the number of nodes and segments, and the selection. The tracing tool itself is in the tool bar.

#include <algorithm>
#include <cmath>

#include <imgui/imgui.h>

#include "engine/workbench/bindings/hints.h"
#include "engine/workbench/edits/edit.h"
#include "engine/workbench/edits/trace_ops.h"
#include "ui/panels/panels.h"
#include "ui/panels/widgets.h"

namespace shvr::ui {

namespace {

/// "3 nodes", "1 node"
void count(size_t number, const char* what, bool goes_on)
{
    ImGui::Text("%zu %s%s%s", number, what, number == 1 ? "" : "s", goes_on ? "," : "");
    if (goes_on) ImGui::SameLine(0.0f, 0.35f * ImGui::GetFontSize());
}

void summary(const Model& model)
{
    const TraceSummary trace = model.trace.summary();
    text_label("Trace");
    count(trace.nodes, "node", true);
    count(trace.internodes, "internode", false);
    text_label("Segments");
    ImGui::Text("%zu", trace.segments);
    hint("A segment is a chain of internodes between two branches or ends.");
    text_label("Length");
    const auto group = trace.group_length.find(model.brush().group);
    ImGui::Text("%.4g %s", trace.length, spelled(model.volume.unit));
    if (trace.group_length.size() < 2 && group != trace.group_length.end()) return;
    ImGui::SameLine();
    ImGui::TextDisabled("(group %d: %.4g)", int(model.brush().group),
                        group == trace.group_length.end() ? 0.0 : group->second);
}

void group_of_selected(const Model& model, uint8_t group)
{
    text_label("Group");
    const ColorGroup look = group_of(model.session.groups, group);
    ImGui::Text("%d, %s", int(group), look.name.c_str());
}

/// Draws the radius field. When it loses focus or the mouse is released, the change becomes one step of the history.
void radius(const Model& model, double radius_units, Actions& actions)
{
    static double edited = 0.0;
    static bool is_edited = false;
    const double voxel = model.volume.spacing.x;
    if (!is_edited) edited = radius_units / voxel;
    label("Radius");
    ImGui::SetNextItemWidth(8.0f * ImGui::GetFontSize());
    constexpr double LEAST = 0.0, MOST = 1000.0;
    drag_number("##node radius", edited, 0.05, LEAST, MOST, "%.2f voxels");
    is_edited = ImGui::IsItemActive();
    if (ImGui::IsItemDeactivatedAfterEdit() && edited != radius_units / voxel)
        actions.push_back(RadiusOp{.radius_voxels = edited});
    hint(sentence("Drag sideways, or Ctrl + click to type. ", name_with_key("larger_selected", model.keymap), ". ",
                  name_with_key("smaller_selected", model.keymap), ".")
             .c_str());
    if (model.volume.unit == "voxel") return;
    ImGui::SameLine();
    ImGui::TextDisabled("= %.4g %s", edited * voxel, spelled(model.volume.unit));
}

void selected_node(const Model& model, uint32_t number, Actions& actions)
{
    const TraceNode& node = model.trace.node(number);
    const size_t links = model.trace.internodes_of(number).size();
    text_label("Selected");
    ImGui::Text("node %u, %zu internode%s", number, links, links == 1 ? "" : "s");
    const glm::dvec3 voxel = node.position / model.volume.spacing;
    text_label("At voxel");
    ImGui::Text("%.1f, %.1f, %.1f", voxel.x, voxel.y, voxel.z);
    if (model.volume.unit != "voxel") {
        text_label("");
        ImGui::TextDisabled("= %.4g, %.4g, %.4g %s", node.position.x, node.position.y, node.position.z,
                            spelled(model.volume.unit));
    }
    group_of_selected(model, node.group);
    radius(model, node.radius, actions);
}

void selected_internode(const Model& model, uint32_t number)
{
    const TraceInternode& internode = model.trace.internode(number);
    text_label("Selected");
    ImGui::Text("internode %u, node %u to %u", number, internode.a, internode.b);
    text_label("Length");
    ImGui::Text("%.4g %s", model.trace.length_of(internode), spelled(model.volume.unit));
    group_of_selected(model, internode.group);
}

void selected_segment(const Model& model, const TraceSelection& selected)
{
    text_label("Selected");
    count(selected.internodes.size(), "internode", true);
    count(selected.nodes.size(), "node", false);
    double length = 0.0;
    for (const uint32_t internode : selected.internodes)
        length += model.trace.length_of(model.trace.internode(internode));
    text_label("Length");
    ImGui::Text("%.4g %s", length, spelled(model.volume.unit));
}

void selection(const Model& model, Actions& actions)
{
    const TraceSelection& selected = model.trace.selection();
    if (const auto node = selected.node()) return selected_node(model, *node, actions);
    if (const auto internode = selected.internode()) return selected_internode(model, *internode);
    if (!selected.empty()) return selected_segment(model, selected);
    text_label("Selected");
    const char* const next = model.trace.nodes().empty() ? "add_node" : "select_nearest";
    ImGui::TextDisabled("nothing");
    hint((name_with_key(next, model.keymap) + ".").c_str());
}

void button(const char* name, bool is_enabled, const char* text, const Action& action, Actions& actions)
{
    ImGui::BeginDisabled(!is_enabled);
    if (ImGui::Button(name)) actions.push_back(action);
    ImGui::EndDisabled();
    hint(text);
}

void buttons(const Model& model, Actions& actions)
{
    const TraceSelection& selected = model.trace.selection();
    button(
        "Segment", !selected.empty(),
        ("Selects the whole chain between two branches or ends" + key_in_brackets("select_segment", model.keymap) + ".")
            .c_str(),
        SelectSegmentOp{}, actions);
    ImGui::SameLine();
    button("Move here", !selected.empty(),
           ("Moves the selected node to the probe, or a whole segment, its nearest node to the probe. " +
            name_with_key("drag_node", model.keymap) + ".")
               .c_str(),
           move_to_probe(model), actions);
    ImGui::SameLine();
    button("Delete", !selected.empty(),
           ("Deletes the selection" + key_in_brackets("delete_selected", model.keymap) +
            "; a node's internodes go with it.")
               .c_str(),
           DeleteOp{}, actions);
    ImGui::SameLine();
    button("Deselect", !selected.empty(),
           ("Deselects" + key_in_brackets("deselect", model.keymap) + ", so that the next node starts a new trace.")
               .c_str(),
           DeselectOp{}, actions);
    const std::string group = std::to_string(model.brush().group);
    ImGui::BeginDisabled(model.brush().group == 0);
    button(("To group " + group).c_str(), !selected.empty(),
           "Moves the selection to the active group. The menu Trace has the keys.", GroupOp{model.brush().group},
           actions);
    ImGui::EndDisabled();
}

/// Draws the choice whether the selected group's internodes taper from node to node or have a radius of their own.
void tapering(const Model& model, Actions& actions)
{
    if (model.trace.internodes().empty() || model.brush().group == 0) return;
    const auto found = model.trace.internode_radii().find(model.brush().group);
    bool tapers = found == model.trace.internode_radii().end();
    label("Internodes");
    const std::string text = "of group " + std::to_string(model.brush().group) + " taper";
    if (ImGui::Checkbox(text.c_str(), &tapers)) {
        RadiusOp op = scaled(model, 1.0);
        if (tapers) op.radius_voxels.reset();
        op.of = RadiusOp::Of::internodes;
        op.group = model.brush().group;
        actions.push_back(op);
    }
    hint(
        "Tapers from node to node; otherwise all of the group have one size, which the keys that change selected nodes "
        "change while nothing is selected.");
    if (found == model.trace.internode_radii().end()) return;
    ImGui::SameLine();
    ImGui::TextDisabled("%.4g %s", found->second, spelled(model.volume.unit));
}

}  // namespace

void trace_panel(const Model& model, Actions& actions)
{
    summary(model);
    selection(model, actions);
    buttons(model, actions);
    new_nodes(model, actions);
    tapering(model, actions);
}

}  // namespace shvr::ui
