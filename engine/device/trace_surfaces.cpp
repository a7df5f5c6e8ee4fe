#include "engine/device/trace_surfaces.h"

#include <algorithm>
#include <array>
#include <set>

namespace shvr {

namespace {

/// Looks up each group only once.
class TraceLook {
public:
    TraceLook(const TraceGraph& trace, const Groups& groups, const glm::dvec3& spacing)
        : trace_(trace), groups_(groups), least_(0.5 * std::min({spacing.x, spacing.y, spacing.z}))
    {}

    /// Null if the group is hidden.
    std::optional<KeyedSurface> of(uint32_t number, const TraceNode& node)
    {
        const Look& look = look_of(node.group);
        if (!look.visible) return std::nullopt;
        const double radius = std::max(shown(node.radius), NODE_FACTOR * thickest_at(number));
        return KeyedSurface{surface_key(SurfaceKind::node, number),
                            {node.position, node.position, radius, radius, look.color}};
    }
    std::optional<KeyedSurface> of(uint32_t number, const TraceInternode& internode)
    {
        const Look& look = look_of(internode.group);
        if (!look.visible) return std::nullopt;
        return KeyedSurface{
            surface_key(SurfaceKind::internode, number),
            {trace_.node(internode.a).position, trace_.node(internode.b).position,
             shown(trace_.radius_of(internode, 0.0)), shown(trace_.radius_of(internode, 1.0)), look.color}};
    }

private:
    struct Look {
        bool visible;
        glm::dvec3 color;
    };
    /// Returns the radius, as drawn, of the thickest visible internode where it meets a node; 0 where there is none.
    double thickest_at(uint32_t node)
    {
        double thickest = 0.0;
        for (const uint32_t number : trace_.internodes_of(node)) {
            const TraceInternode& internode = trace_.internode(number);
            if (!look_of(internode.group).visible) continue;
            thickest = std::max(thickest, shown(trace_.radius_of(internode, internode.a == node ? 0.0 : 1.0)));
        }
        return thickest;
    }
    double shown(double radius) const { return radius > 0.0 ? radius : least_; }
    const Look& look_of(uint8_t group)
    {
        std::optional<Look>& look = looks_[group];
        if (!look) {
            const ColorGroup found = group_of(groups_, group);
            look = Look{found.visible, found.color};
        }
        return *look;
    }

    const TraceGraph& trace_;
    const Groups& groups_;
    double least_;
    std::array<std::optional<Look>, 256> looks_{};
};

}  // namespace

std::vector<KeyedSurface> surfaces_of(const TraceGraph& trace, const Groups& groups, const glm::dvec3& spacing)
{
    TraceLook look(trace, groups, spacing);
    std::vector<KeyedSurface> surfaces;
    surfaces.reserve(trace.nodes().size() + trace.internodes().size());
    const auto add = [&](const auto& numbered) {
        for (const auto& [number, what] : numbered)
            if (const auto surface = look.of(number, what)) surfaces.push_back(*surface);
    };
    add(trace.nodes());
    add(trace.internodes());
    return surfaces;
}

std::optional<ChangedSurfaces> changed_surfaces(const TraceGraph& trace, const Groups& groups,
                                                const glm::dvec3& spacing, std::span<const Change> changes)
{
    std::set<uint32_t> nodes, internodes;
    for (const Change& change : changes) {
        const auto* const of_trace = std::get_if<TraceChange>(&change);
        if (!of_trace) continue;
        if (const auto* node = std::get_if<TraceNodeChange>(of_trace)) {
            nodes.insert(node->node);
            const std::span<const uint32_t> around = trace.internodes_of(node->node);
            internodes.insert(around.begin(), around.end());
        } else if (const auto* internode = std::get_if<TraceInternodeChange>(of_trace)) {
            internodes.insert(internode->internode);
            for (const auto& ends : {internode->before, internode->after})
                if (ends) nodes.insert({ends->a, ends->b});
        } else if (std::holds_alternative<TraceSizeChange>(*of_trace)) {
            return std::nullopt;
        }
    }
    TraceLook look(trace, groups, spacing);
    ChangedSurfaces changed;
    const auto add = [&](SurfaceKind kind, const std::set<uint32_t>& numbers, const auto& numbered) {
        for (const uint32_t number : numbers) {
            changed.keys.push_back(surface_key(kind, number));
            const auto found = numbered.find(number);
            if (found == numbered.end()) continue;
            if (const auto surface = look.of(number, found->second)) changed.now.push_back(*surface);
        }
    };
    add(SurfaceKind::node, nodes, trace.nodes());
    add(SurfaceKind::internode, internodes, trace.internodes());
    return changed;
}

namespace {

/// Accumulates the box around balls.
class Reach {
public:
    void add(const TraceNode& node) { add(node.position, node.radius); }
    void add(const glm::dvec3& position, double radius)
    {
        const double drawn = NODE_FACTOR * radius;
        lower_ = glm::min(lower_, position - drawn);
        upper_ = glm::max(upper_, position + drawn);
    }
    /// Returns the box enlarged by one voxel on each side, to cover nodes without a radius.
    VoxelBox box(const glm::dvec3& spacing) const
    {
        if (lower_.x > upper_.x) return {};
        return {Size3(glm::floor(lower_ / spacing)) - int64_t{1}, Size3(glm::ceil(upper_ / spacing)) + int64_t{1}};
    }

private:
    glm::dvec3 lower_{1e300}, upper_{-1e300};
};

}  // namespace

VoxelBox trace_reach(const TraceGraph& trace, std::span<const Change> changes, const glm::dvec3& spacing)
{
    Reach reach;
    double thickest = 0.0;
    for (const auto& [group, radius] : trace.internode_radii()) thickest = std::max(thickest, radius);
    const auto add_node = [&](uint32_t number) {
        const auto found = trace.nodes().find(number);
        if (found == trace.nodes().end()) return;  // the node was removed; its own change contains its old position
        reach.add(found->second);
        reach.add(found->second.position, thickest);
    };
    const auto add_changed = [&](uint32_t number, const std::optional<TraceNode>& node) {
        if (!node) return;
        reach.add(*node);
        reach.add(node->position, thickest);
        if (!trace.nodes().contains(number)) return;
        for (const uint32_t internode : trace.internodes_of(number)) add_node(trace.internode(internode).other(number));
    };
    for (const Change& change : changes) {
        const auto* const of_trace = std::get_if<TraceChange>(&change);
        if (!of_trace) continue;
        if (const auto* node = std::get_if<TraceNodeChange>(of_trace)) {
            add_changed(node->node, node->before);
            add_changed(node->node, node->after);
        } else if (const auto* internode = std::get_if<TraceInternodeChange>(of_trace)) {
            for (const auto& ends : {internode->before, internode->after})
                if (ends) add_node(ends->a), add_node(ends->b);
        } else if (const auto* size = std::get_if<TraceSizeChange>(of_trace)) {
            const double largest = std::max({thickest, size->before.value_or(0.0), size->after.value_or(0.0)});
            for (const auto& [number, any] : trace.nodes()) reach.add(any.position, std::max(largest, any.radius));
        }
    }
    return reach.box(spacing);
}

}  // namespace shvr
