#include "engine/workbench/sight/hits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/look/groups.h"

namespace shvr::ui {

namespace {

constexpr double NODE_PIXELS = 6.0, INTERNODE_PIXELS = 4.0;

bool is_before_eye(const Camera& camera, double depth)
{
    return depth >= camera.near_distance && (camera.far_distance <= 0.0 || depth <= camera.far_distance);
}

struct Near {
    double pixels = std::numeric_limits<double>::infinity(), share = 0.0;
};

Near nearest_on(const glm::dvec2& from, const glm::dvec2& to, const glm::dvec2& pixel)
{
    const glm::dvec2 way = to - from;
    const double square = glm::dot(way, way);
    const double share = square > 0.0 ? std::clamp(glm::dot(pixel - from, way) / square, 0.0, 1.0) : 0.0;
    return {glm::distance(pixel, from + share * way), share};
}

}  // namespace

double behind_plane(const Camera& camera, const glm::dvec3& point)
{
    return glm::dot(point - camera.eye, axes_of(camera).forward) - 0.5 * (camera.near_distance + camera.far_distance);
}

std::bitset<256> groups_in_pane(const Session& session, const Pane& pane)
{
    std::bitset<256> drawn;
    if (pane.kind != Pane::Kind::slice && !session.view.meshes) return drawn;
    drawn.set();
    const Groups shown = session.shown_groups();
    for (const auto& [group, settings] : shown) drawn[group] = group_of(shown, group).visible;
    return drawn;
}

namespace {

/// Of the parts that a click meets, the nearest to the viewer; of all others, the nearest in pixels.
class Choice {
public:
    explicit Choice(double spare) : spare_(spare) {}

    /// `away`: pixels outside the part's own reach; at most 0 for a part that is met.
    void offer(double away, const TraceHit& hit)
    {
        if (away <= 0.0) {
            if (!met_ || hit.depth < met_->depth) met_ = hit;
        } else if (away < spare_) {
            spare_ = away;
            near_ = hit;
        }
    }
    const std::optional<TraceHit>& met() const { return met_; }
    TraceHit chosen() const { return met_ ? *met_ : near_; }

private:
    double spare_;
    std::optional<TraceHit> met_;
    TraceHit near_{};
};

}  // namespace

TraceHit trace_hit(const TraceGraph& trace, const Pane& pane, const glm::dvec2& pixel, const VolumeInfo& volume,
                   const std::bitset<256>& drawn, double spare)
{
    const Camera& camera = pane.shot.camera;
    const glm::uvec2 pixels = pane.pixels();
    const bool is_slice = pane.kind == Pane::Kind::slice;
    const double half_voxel = is_slice ? 0.5 * volume.spacing[std::clamp(pane.axis, 0, 2)] : 0.0;
    const auto is_shown = [&](const glm::dvec3& point, double depth, double radius) {
        return is_slice ? std::abs(behind_plane(camera, point)) <= std::max(radius, half_voxel)
                        : is_before_eye(camera, depth);
    };
    Choice choice(spare);
    for (const auto& [number, node] : trace.nodes()) {
        if (!drawn[node.group]) continue;
        const auto at = project(camera, pixels, node.position);
        if (!at || !is_shown(node.position, at->depth, node.radius)) continue;
        const double reach = std::max(node.radius / pixel_size(camera, pixels, at->depth), NODE_PIXELS);
        choice.offer(glm::distance(at->pixel, pixel) - reach,
                     {.node = number, .internode = {}, .depth = at->depth, .radius = node.radius});
    }
    if (choice.met()) return choice.chosen();
    for (const auto& [number, internode] : trace.internodes()) {
        if (!drawn[internode.group]) continue;
        const glm::dvec3 &a = trace.node(internode.a).position, &b = trace.node(internode.b).position;
        const auto from = project(camera, pixels, a), to = project(camera, pixels, b);
        if (!from || !to) continue;
        const Near near = nearest_on(from->pixel, to->pixel, pixel);
        const glm::dvec3 point = glm::mix(a, b, near.share);
        const double depth = glm::mix(from->depth, to->depth, near.share),
                     radius = trace.radius_of(internode, near.share);
        const double reach = std::max(radius / pixel_size(camera, pixels, depth), INTERNODE_PIXELS);
        if (!is_shown(point, depth, radius)) continue;
        choice.offer(near.pixels - reach, {.node = {}, .internode = number, .depth = depth, .radius = radius});
    }
    return choice.chosen();
}

}  // namespace shvr::ui
