#pragma once
// Actions on the trace. The operations with which scripts change the trace are actions, too.

#include "engine/annotation/script/script.h"
#include "engine/workbench/actions/action_row.h"

namespace shvr::ui {

class Tracer;

/// Maximum distance from the probe, in radii of the probe, at which a node counts as near the probe.
inline constexpr double NEARBY_RADII = 4.0;

struct DragNode {  ///< moves the selection with the probe, until released; the whole drag becomes one history step
    bool on = false;
};

/// Adds a node at the visible point and links it with the selected node.
struct NodeAt {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
};

/// Selects the visible node or internode at the pixel. If there is none, activates the group painted there; if there is
/// no paint either, clears the selection.
struct SelectAt {
    size_t pane = 0;
    glm::dvec2 pixel{0.0};
    bool whole_segment = false;
};

/// Selects the next node, by number, among nodes that clicks and keys can select, and points the camera at the node.
struct StepNode {
    bool back = false;
};

/// Links the two nodes that lost their connection in the last deletion.
struct MendCut {};

inline constexpr const char* TRACING_GROUP = "Tracing";

inline constexpr auto TRACING_ACTIONS = std::tuple{
    row<DragNode, Tracer>(
        {"drag_node", "Move the selection", TRACING_GROUP,
         "moves the selected node or segment with the probe until released"},
        [](auto& f, DragNode& a) { f.flag("on", a.on, {.is_required = true}); },
        [](const auto& model, const DragNode& action) -> std::string {
            return action.on ? why_without_selection(model) : std::string();
        }),
    row<NodeOp, Tracer>({"node", "Add a node", TRACING_GROUP, "adds a node, linked with the selected one"}, NO_FIELDS,
                        [](const auto& model, const NodeOp& action) -> std::string {
                            if (action.divides && !model.trace.internodes().contains(*action.divides))
                                return sentence("there is no internode ", *action.divides);
                            if (action.divides && !action.group) return why_not_traced(model);
                            return why_without_group(model, action.group.value_or(model.brush().group));
                        }),
    row<SelectOp, Tracer>(
        {"select", "Select", TRACING_GROUP, "selects a node or an internode, by number or the nearest"}, NO_FIELDS,
        [](const auto& model, const SelectOp&) -> std::string {
            if (model.is_painting) return IS_PAINTING;
            return model.trace.nodes().empty() ? "there is no node" : "";
        }),
    row<SelectSegmentOp, Tracer>(
        {"select_segment", "Select the segment", TRACING_GROUP, "selects everything between two branches or ends"},
        NO_FIELDS,
        [](const auto& model, const SelectSegmentOp&) -> std::string {
            if (model.is_painting) return IS_PAINTING;
            return model.trace.selection().empty() ? "nothing is selected" : "";
        }),
    row<DeselectOp, Tracer>({"deselect", "Deselect", TRACING_GROUP, "clears the selection"}, NO_FIELDS,
                            [](const auto& model, const DeselectOp&) -> std::string {
                                return model.trace.selection().empty() ? "nothing is selected" : "";
                            }),
    row<LinkOp, Tracer>({"link", "Link", TRACING_GROUP, "links the selected node with another"}, NO_FIELDS,
                        [](const auto& model, const LinkOp&) -> std::string { return why_without_node(model); }),
    row<MoveOp, Tracer>(
        {"move", "Move to", TRACING_GROUP,
         "moves the selected node to a voxel, or all that is selected by `to` - `from`"},
        NO_FIELDS,
        [](const auto& model, const MoveOp& action)
            -> std::string { return action.from ? why_without_selection(model) : why_without_node(model); }),
    row<DeleteOp, Tracer>(
        {"delete", "Delete", TRACING_GROUP, "deletes the selection"}, NO_FIELDS,
        [](const auto& model, const DeleteOp&) -> std::string { return why_without_selection(model); }),
    row<GroupOp, Tracer>({"group", "Change group", TRACING_GROUP, "moves the selection to a group"}, NO_FIELDS,
                         [](const auto& model, const GroupOp& action) -> std::string {
                             return action.group == 0 ? "group 0 is the eraser, and traces belong to a group from 1 up"
                                                      : why_without_selection(model);
                         }),
    row<RadiusOp, Tracer>(
        {"radius", "Change radius", TRACING_GROUP, "sets radii of the selection, or of a group"}, NO_FIELDS,
        [](const auto& model, const RadiusOp& action) -> std::string {
            return action.of == RadiusOp::Of::selected ? why_without_selection(model) : why_not_traced(model);
        }),
    row<NodeAt, Tracer>(
        {"node_at", "Add a node where it is seen", TRACING_GROUP, "adds a node at the point seen at a pixel of a pane"},
        [](auto& f, NodeAt& a) {
            pane_field(f, a.pane);
            pixel_field(f, "pixel", a.pixel);
        },
        [](const auto& model, const NodeAt&) -> std::string { return why_without_group(model, model.brush().group); }),
    row<SelectAt, Tracer>(
        {"select_at", "Select at the pointer", TRACING_GROUP,
         "selects the node, internode or group at a pixel of a pane"},
        [](auto& f, SelectAt& a) {
            pane_field(f, a.pane);
            pixel_field(f, "pixel", a.pixel);
            f.flag("whole_segment", a.whole_segment, {});
        },
        [](const auto& model, const SelectAt&) -> std::string { return model.is_painting ? IS_PAINTING : ""; }),
    row<StepNode, Tracer>(
        {"step_node", "Next node", TRACING_GROUP, "selects the next or previous node that is shown, and looks at it"},
        [](auto& f, StepNode& a) { f.flag("back", a.back, {}); },
        [](const auto& model, const StepNode&) -> std::string {
            if (model.is_painting) return IS_PAINTING;
            return model.trace.nodes().empty() ? "there is no node" : "";
        }),
    row<MendCut, Tracer>(
        {"mend_cut", "Mend the cut", TRACING_GROUP, "links the nodes that were separated by deleting one between them"},
        NO_FIELDS, [](const auto& model, const MendCut&) -> std::string {
            const std::string why = why_not_traced(model);
            return why.empty() && !model.is_cut ? "the last deletion cut nothing in two" : why;
        })};

}  // namespace shvr::ui
