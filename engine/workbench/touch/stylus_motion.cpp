#include "engine/workbench/touch/stylus_motion.h"

#include <algorithm>
#include <cmath>

#include "engine/live/felt_limits.h"

namespace shvr::ui {

namespace {

/// Columns: right, up, towards the viewer.
glm::dmat3 frame_of(const Camera& camera)
{
    const CameraAxes axes = axes_of(camera);
    return {axes.right, axes.up, -axes.forward};
}

int axis_of(TouchPlane plane)
{
    return int(plane) - int(TouchPlane::x);
}

}  // namespace

Workspace workspace_in_view(const Camera& camera, double view_height, double scale)
{
    return {.to_volume = frame_of(camera) * (scale * view_height / WORKSPACE_M), .origin = camera.target};
}

Camera camera_of_grab(const Grab& grab, const glm::dvec3& position_m, const glm::dquat& rotation, double units_per_m)
{
    // Since the grab, a point v of the volume, in view coordinates, has moved to turn * (v - before) + after.
    const glm::dmat3 turn = glm::mat3_cast(glm::normalize(rotation) * glm::inverse(glm::normalize(grab.rotation)));
    const glm::dvec3 before = units_per_m * grab.position_m, after = units_per_m * position_m;
    const glm::dmat3 was = frame_of(grab.camera), is = was * glm::transpose(turn);
    Camera camera = grab.camera;
    camera.target = grab.camera.target + was * before - is * after;
    camera.eye = camera.target + is[2] * glm::distance(grab.camera.eye, grab.camera.target);
    camera.up = is[1];
    return camera;
}

PlaneHold plane_of(TouchPlane plane, const glm::dvec3& point, const Workspace& workspace, uint32_t count)
{
    PlaneHold hold;
    hold.count = count;
    hold.is_on = plane != TouchPlane::none;
    if (!hold.is_on) return hold;
    glm::dvec3 across(0.0);
    across[axis_of(plane)] = 1.0;
    // to_volume is a rotation times a scale, so its transpose maps normals to the device's frame (then normalized).
    hold.normal = glm::normalize(glm::transpose(workspace.to_volume) * across);
    hold.point_m = glm::inverse(workspace.to_volume) * (point - workspace.origin);
    return hold;
}

glm::dvec3 in_plane(TouchPlane plane, const glm::dvec3& on, const glm::dvec3& point)
{
    glm::dvec3 held = point;
    if (plane != TouchPlane::none) held[axis_of(plane)] = on[axis_of(plane)];
    return held;
}

std::optional<double> radius_from_overlap(double share, double ball_radius)
{
    if (!(share > 0.0) || !(ball_radius > 0.0)) return std::nullopt;
    return ball_radius * std::sqrt(1.0 - std::pow(1.0 - std::min(share, 1.0), 2.0 / 3.0));
}

ToolPlace tool_place(const FeelSettings& feel, const TraceGraph& trace, const glm::dvec3& point, double reach,
                     std::optional<uint32_t> except_of, const std::bitset<256>& drawn)
{
    const auto at = [&](uint32_t node) { return ToolPlace{trace.node(node).position, node, {}}; };
    if (feel.to_nodes)
        if (const auto node = nearest_node_of(trace, drawn, point, reach)) return at(*node);
    const auto place = feel.to_lines ? nearest_place(trace, point, reach, except_of, drawn) : std::nullopt;
    if (!place) return {point, {}, {}};
    const TraceInternode& internode = trace.internode(place->internode);
    if (place->share <= 0.0) return at(internode.a);
    if (place->share >= 1.0) return at(internode.b);
    return {place->position, {}, place->internode};
}

std::bitset<256> groups_found_nearby(const Session& session)
{
    return session.probe.touch.feels_hidden ? EVERY_GROUP : drawn_groups(session.shown_groups(), false);
}

}  // namespace shvr::ui
