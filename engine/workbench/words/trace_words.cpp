#include "engine/workbench/words/trace_words.h"

namespace shvr::ui {

namespace {

std::string counted(size_t number, const char* what)
{
    return sentence(number, " ", what, number == 1 ? "" : "s");
}

}  // namespace

std::string said_of(const TraceOp& op, bool selects, const Command* done, const TraceGraph& trace,
                    const TraceSize& before)
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
    if (const NodeOp* added = std::get_if<NodeOp>(&op)) {
        const uint32_t node = *selected.node();
        const auto internodes = trace.internodes_of(node);
        if (added->divides) {
            const std::string said = sentence("Node ", node, " divides internode ", *added->divides);
            if (internodes.size() < 3) return said;
            return sentence(said, ", and is linked with node ", trace.internode(internodes[2]).other(node));
        }
        if (internodes.empty()) return sentence("Node ", node, " added");
        return sentence("Node ", node, " added, linked with node ", trace.internode(internodes[0]).other(node));
    }
    const std::string what = selected.node()        ? sentence("Node ", *selected.node())
                             : selected.internode() ? sentence("Internode ", *selected.internode())
                             : selected.empty()     ? std::string()
                                                    : std::string("What is selected");
    if (std::holds_alternative<MoveOp>(op)) return what + " was moved";
    if (std::holds_alternative<DeleteOp>(op))
        return sentence("Deleted: ", counted(before.nodes - trace.nodes().size(), "node"), ", ",
                        counted(before.internodes - trace.internodes().size(), "internode"));
    if (const LinkOp* link = std::get_if<LinkOp>(&op); link && link->node)
        return sentence(what, " is linked with node ", *link->node);
    if (std::holds_alternative<LinkOp>(op)) return what + " is linked with the nearest node";
    if (const GroupOp* group = std::get_if<GroupOp>(&op))
        return sentence(what, " belongs to group ", int(group->group));
    if (const RadiusOp* radius = std::get_if<RadiusOp>(&op); radius && radius->of != RadiusOp::Of::selected)
        return sentence(radius->of == RadiusOp::Of::nodes ? "Nodes" : "Internodes", " of group ", int(radius->group),
                        radius->radius_voxels ? " have another radius" : " taper");
    return what + " has another radius";
}

}  // namespace shvr::ui
