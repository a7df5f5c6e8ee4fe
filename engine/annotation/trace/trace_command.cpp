#include "engine/annotation/trace/trace_command.h"

#include <algorithm>

#include "engine/annotation/trace/trace_edit.h"
#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

class Effects {
public:
    Effects(const TraceGraph& trace, const TraceDefaults& defaults) : trace_(trace), defaults_(defaults) {}

    TraceEffect operator()(const NodeOp& op) const
    {
        if (op.divides) return dividing(op);
        const TraceNode node{at(op.at), length(op.radius_voxels.value_or(defaults_.radius_voxels)),
                             op.group.value_or(defaults_.group)};
        check_place(op.at, node.radius);
        return {sentence("added a node in group ", int(node.group)), add_node(trace_, node), {}};
    }
    TraceEffect operator()(const SelectOp& op) const
    {
        const char* const what = op.is_internode ? "internode" : "node";
        TraceSelection selection;
        if (op.number) {
            const bool is_there =
                op.is_internode ? trace_.internodes().contains(*op.number) : trace_.nodes().contains(*op.number);
            if (!is_there) fail(what, " ", *op.number, " does not exist; expected one of the trace");
            (op.is_internode ? selection.internodes : selection.nodes).assign(1, *op.number);
        }
        if (op.near) {
            const glm::dvec3 near = at(*op.near);
            selection = op.is_internode ? nearest_internode_selection(trace_, near, defaults_.found)
                                        : nearest_node_selection(trace_, near, defaults_.found);
            const double away = op.is_internode ? distance_to(trace_, trace_.internode(selection.internodes[0]), near)
                                                : glm::length(trace_.node(selection.nodes[0]).position - near);
            check_distance(what, away, op.within_voxels);
        }
        return {"select", {}, std::move(selection)};
    }
    TraceEffect operator()(const SelectSegmentOp&) const { return {"select", {}, segment_selection(trace_)}; }
    TraceEffect operator()(const DeselectOp&) const { return {"deselect", {}, TraceSelection{}}; }
    TraceEffect operator()(const LinkOp& op) const
    {
        if (op.node && !trace_.nodes().contains(*op.node))
            fail("node ", *op.node, " does not exist; expected one of the trace");
        std::optional<uint32_t> to = op.node;
        if (!to) {
            to = nearest_node_of(trace_, defaults_.found, at(*op.near), std::numeric_limits<double>::infinity(),
                                 trace_.selection().node());
            if (!to)
                fail("the trace has no other node", defaults_.found.all() ? "" : " in a group that is shown",
                     "; expected one to link to");
            check_distance("other node", glm::length(trace_.node(*to).position - at(*op.near)), op.within_voxels);
        }
        return {"linked two nodes", link_selected(trace_, *to), {}};
    }
    TraceEffect operator()(const MoveOp& op) const
    {
        if (op.from) {
            const glm::dvec3 by = op.to - *op.from;
            for (const uint32_t number : nodes_of_selection(trace_)) {
                const TraceNode& node = trace_.node(number);
                check_place(node.position / defaults_.spacing + by, node.radius);
            }
            return {"moved a segment", shift_selected(trace_, at(by)), {}};
        }
        const std::optional<uint32_t> moved = trace_.selection().node();
        if (moved) check_place(op.to, trace_.node(*moved).radius);
        return {"moved a node", move_selected(trace_, at(op.to)), {}};
    }
    TraceEffect operator()(const DeleteOp&) const { return {"deleted part of the trace", delete_selected(trace_), {}}; }
    TraceEffect operator()(const GroupOp& op) const
    {
        return {
            sentence("moved part of the trace to group ", int(op.group)), set_group_of_selected(trace_, op.group), {}};
    }
    TraceEffect operator()(const RadiusOp& op) const
    {
        const std::optional<double> radius = op.radius_voxels ? std::optional(length(*op.radius_voxels)) : std::nullopt;
        switch (op.of) {
            case RadiusOp::Of::nodes:
                return {"changed the radius of nodes", set_node_radii(trace_, op.group, radius.value()), {}};
            case RadiusOp::Of::internodes:
                return {"changed the radius of internodes", set_internode_radius(trace_, op.group, radius), {}};
            case RadiusOp::Of::selected: break;
        }
        return {"changed a radius", set_radius_of_selected(trace_, radius.value()), {}};
    }

private:
    TraceEffect dividing(const NodeOp& op) const
    {
        const uint32_t number = *op.divides;
        if (!trace_.internodes().contains(number))
            fail("internode ", number, " does not exist; expected one of the trace");
        const TraceInternode& internode = trace_.internode(number);
        const double here = trace_.radius_of(internode, share_along(trace_, internode, at(op.at)));
        const TraceNode node{at(op.at), op.radius_voxels ? length(*op.radius_voxels) : here,
                             op.group.value_or(internode.group)};
        check_place(op.at, node.radius);
        return {sentence("added a node in internode ", number), divide_internode(trace_, number, node), {}};
    }
    glm::dvec3 at(const glm::dvec3& voxel) const { return voxel * defaults_.spacing; }
    double length(double voxels) const { return voxels * defaults_.spacing.x; }
    /// Nodes may lie outside the volume by their radius, since tubes may extend there; nodes further out are errors.
    void check_place(const glm::dvec3& voxel, double radius) const
    {
        const glm::dvec3 size(defaults_.size), spacing = defaults_.spacing;
        const double outside = glm::length((voxel - glm::clamp(voxel, glm::dvec3(0.0), size)) * spacing);
        const double allowed = radius + std::max({spacing.x, spacing.y, spacing.z});
        if (defaults_.size == Size3(0) || outside <= allowed) return;
        fail("the node at ", digits_of(voxel), " is ", outside / length(1.0), " voxel widths outside the volume of ",
             defaults_.size.x, " x ", defaults_.size.y, " x ", defaults_.size.z, " voxels; expected at most ",
             allowed / length(1.0), ", its radius and the longest side of a voxel");
    }
    void check_distance(const char* what, double away, const std::optional<double>& within_voxels) const
    {
        if (within_voxels && away > length(*within_voxels))
            fail("the nearest ", what, " is ", away / length(1.0), " voxels away; expected one within ",
                 *within_voxels);
    }

    const TraceGraph& trace_;
    const TraceDefaults& defaults_;
};

}  // namespace

TraceEffect effect_of(const TraceOp& op, const TraceGraph& trace, const TraceDefaults& defaults)
{
    return std::visit(Effects(trace, defaults), op);
}

}  // namespace shvr
