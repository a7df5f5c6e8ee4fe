#include "engine/workbench/edits/trace_ops.h"

#include <algorithm>
#include <vector>

namespace shvr::ui {

namespace {

double within_voxels(const Model& model)
{
    return NEARBY_RADII * model.brush().radius_voxels;
}

class Mean {
public:
    void add(double value)
    {
        sum_ += value;
        ++count_;
    }
    double value_or(double other) const { return count_ > 0 ? sum_ / double(count_) : other; }

private:
    double sum_ = 0.0;
    int64_t count_ = 0;
};

/// Returns factor * max(mean radius, half a voxel), in voxels along x. Without a mean, uses the probe's radius.
double scaled_radius(const Model& model, const Mean& mean, double factor)
{
    const double probe = model.brush().radius_voxels * model.volume.spacing.x;
    return std::max(mean.value_or(probe) / model.volume.spacing.x, 0.5) * factor;
}

}  // namespace

NodeOp node_at_probe(const Model& model)
{
    return NodeOp{.at = model.tool_voxel, .radius_voxels = {}, .group = model.brush().group};
}

Action node_or_link_at_probe(const Model& model)
{
    return trace_op_at({model.tool_voxel * model.volume.spacing, model.tool_node, model.tool_internode}, model.trace,
                       model.volume.spacing)
        .value_or(node_at_probe(model));
}

std::optional<Action> trace_op_at(const ToolPlace& place, const TraceGraph& trace, const glm::dvec3& spacing)
{
    if (place.internode)
        return NodeOp{.at = place.point / spacing, .radius_voxels = {}, .group = {}, .divides = place.internode};
    if (!place.node) return std::nullopt;
    const std::optional<uint32_t> selected = trace.selection().node();
    const bool is_linked = selected && trace.internode_between(*selected, *place.node);
    if (selected && *selected != *place.node && !is_linked) return LinkOp{.near = {}, .node = place.node};
    return SelectOp{.near = {}, .number = place.node, .within_voxels = {}};
}

SelectOp nearest_selection(const Model& model)
{
    const std::optional<uint32_t> selected = model.trace.selection().node();
    const bool is_nearest = selected && nearest_node_of(model.trace, groups_found_nearby(model.session),
                                                        model.probe_voxel * model.volume.spacing) == selected;
    SelectOp op{.near = model.probe_voxel, .number = {}, .is_internode = false, .within_voxels = within_voxels(model)};
    if (is_nearest && !model.trace.internodes_of(*selected).empty()) {
        op.is_internode = true;
        op.within_voxels.reset();  // its node is known
    }
    return op;
}

LinkOp link_with_nearest(const Model& model)
{
    return LinkOp{.near = model.probe_voxel, .node = {}, .within_voxels = within_voxels(model)};
}

MoveOp move_to_probe(const Model& model)
{
    MoveOp op{.to = model.probe_voxel};
    if (model.trace.selection().empty() || model.trace.selection().node()) return op;
    const glm::dvec3& spacing = model.volume.spacing;
    const auto distance_of = [&](uint32_t node) {
        return glm::distance(model.trace.node(node).position, model.probe_voxel * spacing);
    };
    std::vector<uint32_t> nodes = model.trace.selection().nodes;
    if (nodes.empty())
        for (const uint32_t number : model.trace.selection().internodes) {
            const TraceInternode& internode = model.trace.internode(number);
            nodes.insert(nodes.end(), {internode.a, internode.b});
        }
    op.from = model.trace.node(*std::ranges::min_element(nodes, {}, distance_of)).position / spacing;
    return op;
}

RadiusOp scaled(const Model& model, double factor)
{
    const TraceSelection& selected = model.trace.selection();
    Mean mean;
    if (!selected.nodes.empty()) {
        for (const uint32_t node : selected.nodes) mean.add(model.trace.node(node).radius);
        return {.of = RadiusOp::Of::selected, .radius_voxels = scaled_radius(model, mean, factor)};
    }
    const uint8_t group =
        selected.internode() ? model.trace.internode(*selected.internode()).group : model.brush().group;
    for (const auto& [number, internode] : model.trace.internodes())
        if (internode.group == group) mean.add(model.trace.radius_of(internode, 0.5));
    return {.of = RadiusOp::Of::internodes, .radius_voxels = scaled_radius(model, mean, factor), .group = group};
}

RadiusOp scaled_nodes_of_group(const Model& model, double factor)
{
    Mean mean;
    for (const auto& [number, node] : model.trace.nodes())
        if (node.group == model.brush().group) mean.add(node.radius);
    return {
        .of = RadiusOp::Of::nodes, .radius_voxels = scaled_radius(model, mean, factor), .group = model.brush().group};
}

std::optional<glm::dvec3> middle_of_selection(const TraceGraph& trace)
{
    const TraceSelection& selected = trace.selection();
    if (selected.empty()) return std::nullopt;
    glm::dvec3 lower(1e300), upper(-1e300);
    const auto add = [&](uint32_t node) {
        lower = glm::min(lower, trace.node(node).position);
        upper = glm::max(upper, trace.node(node).position);
    };
    for (const uint32_t node : selected.nodes) add(node);
    for (const uint32_t internode : selected.internodes) {
        add(trace.internode(internode).a);
        add(trace.internode(internode).b);
    }
    return 0.5 * (lower + upper);
}

}  // namespace shvr::ui
