#pragma once
// What moves of a stylus mean for view, probe and tools. Pure; any thread. Lengths are physical units of the volume
// where nothing else is said.

#include <cstdint>
#include <optional>

#include "engine/annotation/trace/trace_segments.h"
#include "engine/annotation/work/work.h"
#include "engine/look/camera_motion.h"
#include "engine/session/session.h"
#include "engine/workbench/touch/device_tap.h"
#include "haptics/settings.h"

namespace shvr::ui {

/// Width of a haptic device's workspace, mapped to the height of the view.
inline constexpr double WORKSPACE_M = 0.12;

/// A device's workspace lies in the view: right, up and towards the viewer, about the camera's target.
Workspace workspace_in_view(const Camera& camera, double view_height, double scale);

/// A stylus that has taken hold of the volume: where both were then.
struct Grab {
    Camera camera;
    glm::dvec3 position_m{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};
/// Eq. 4.9 of the thesis, M_volume = M_probe M_probe_start^-1 M_volume_start, as a camera: the volume has moved and
/// turned in the view as the stylus has since, about the stylus. `units_per_m`: of the workspace. With it the probe
/// stays on its voxel.
Camera camera_of_grab(const Grab& grab, const glm::dvec3& position_m, const glm::dquat& rotation, double units_per_m);

/// A plane of voxels across an axis through a point, in the device's frame.
PlaneHold plane_of(TouchPlane plane, const glm::dvec3& point, const Workspace& workspace, uint32_t count);
/// The point of that plane through `on` that is nearest to `point`.
glm::dvec3 in_plane(TouchPlane plane, const glm::dvec3& on, const glm::dvec3& point);

/// The radius of a straight tube through the middle of a ball that fills that share of it; null without any.
///   share = 1 - (1 - (tube / ball)^2)^(3/2)
std::optional<double> radius_from_overlap(double share, double ball_radius);

/// Where tools act.
struct ToolPlace {
    glm::dvec3 point{0.0};              ///< volume space
    std::optional<uint32_t> node;       ///< the one that has drawn them
    std::optional<uint32_t> internode;  ///< likewise, between its ends
};
/// A point, or what of the trace within `reach` of it draws tools there, as is wanted: the nearest node, or the nearest
/// point of a centre line, but for the internodes of a node, from which a person goes on.
ToolPlace tool_place(const FeelSettings& feel, const TraceGraph& trace, const glm::dvec3& point, double reach,
                     std::optional<uint32_t> except_of);

}  // namespace shvr::ui
