// Actions on the trace: the operations that scripts use, as commands of the one history.

#include "ui/workbench/workbench.h"

namespace shvr::ui {

namespace {

/// The result, for the status bar.
std::string said_of(const TraceOp& op, bool selects, const Command* done, const TraceGraph& trace)
{
    const TraceSelection& selected = trace.selection();
    if (selects) {
        if (selected.empty()) return "Nothing is selected";
        if (const auto node = selected.node()) return sentence("Node ", *node, " is selected");
        if (const auto internode = selected.internode()) return sentence("Internode ", *internode, " is selected");
        return sentence("A segment is selected: ", selected.internodes.size(), " internodes, ", selected.nodes.size(),
                        " nodes");
    }
    if (!done) return "Nothing to change in the trace";
    if (std::holds_alternative<NodeOp>(op)) {
        const uint32_t node = *selected.node();
        const auto internodes = trace.internodes_of(node);
        if (internodes.empty()) return sentence("Node ", node, " added");
        return sentence("Node ", node, " added, linked with node ", trace.internode(internodes[0]).other(node));
    }
    return "Trace: " + done->label;
}

/// Whether the selected node does, though near enough to be allowed.
bool lies_outside(const TraceGraph& trace, const VolumeInfo& volume)
{
    const std::optional<uint32_t> node = trace.selection().node();
    if (!node) return false;
    const glm::dvec3 voxel = trace.node(*node).position / volume.spacing;
    return glm::any(glm::lessThan(voxel, glm::dvec3(0.0))) ||
           glm::any(glm::greaterThan(voxel, glm::dvec3(volume.size)));
}

}  // namespace

void Workbench::trace(const TraceOp& op)
{
    Annotator& annotator = document_->annotator;
    if (annotator.stroke_is_running()) fail("The trace cannot be edited while a stroke is being painted");
    const TraceGraph& trace = annotator.document().trace;
    if (const NodeOp* node = std::get_if<NodeOp>(&op); node && node->group.value_or(document_->brush().group) == 0)
        fail("Group 0 is the eraser; choose a group from 1 up for the node");
    if (const GroupOp* group = std::get_if<GroupOp>(&op); group && group->group == 0)
        fail("Group 0 is the eraser, and what is traced belongs to a group from 1 up");
    record_settings();
    TraceEffect effect = effect_of(op, trace, document_->trace_defaults());
    if (effect.selection) annotator.work().select_trace(*effect.selection);
    const Command* const done = annotator.edit_trace(std::move(effect.label), std::move(effect.changes));
    document_->drags_node = false;
    if (done) show_changes(*done);
    const std::string said = said_of(op, effect.selection.has_value(), done, trace);
    const bool places = std::holds_alternative<NodeOp>(op) || std::holds_alternative<MoveOp>(op);
    if (done && places && lies_outside(trace, document_->volume()))
        return say(said + "; it lies outside the volume", Weight::warning);
    say(said);
}

void Workbench::act(const DragNode& action)
{
    const TraceGraph& trace = document_->annotator.document().trace;
    if (action.on) {
        const std::optional<uint32_t> node = trace.selection().node();
        if (document_->annotator.stroke_is_running())
            fail("The trace cannot be edited while a stroke is being painted");
        if (!node) fail("No node is selected; select one to move it");
        document_->drags_node = true;
        return say(sentence("Node ", *node, " follows the probe until the key is released"));
    }
    if (document_->drags_node) this->trace(MoveOp{document_->probe_voxel()});
}

}  // namespace shvr::ui
