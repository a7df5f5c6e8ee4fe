#pragma once
// Maps the motion of a stylus to the view, the probe and the tools. Lengths are in the volume's physical units unless
// stated otherwise. Pure; any thread.

#include <bitset>
#include <cstdint>
#include <optional>

#include "engine/annotation/trace/trace_edit.h"
#include "engine/annotation/trace/trace_segments.h"
#include "engine/annotation/work/work.h"
#include "engine/look/camera_motion.h"
#include "engine/session/session.h"
#include "engine/workbench/touch/device_tap.h"
#include "haptics/settings.h"

namespace shvr::ui {

/// Width of a haptic device's workspace, in metres; it is mapped to the height of the view.
inline constexpr double WORKSPACE_M = 0.12;

/// Returns a device's workspace, placed in the view: axes right, up and towards the viewer; its origin is the target.
Workspace workspace_in_view(const Camera& camera, double view_height, double scale);

/// State when the user grabbed the volume: the camera, and position and rotation of the stylus.
struct Grab {
    Camera camera;
    glm::dvec3 position_m{0.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};
/// Returns a camera that implements Eq. 4.9 of the thesis, M_volume = M_probe M_probe_start^-1 M_volume_start: in the
/// view, the volume has moved with the stylus since the grab, and rotated about it. `units_per_m`: the scale of the
/// workspace. The probe stays on its voxel.
Camera camera_of_grab(const Grab& grab, const glm::dvec3& position_m, const glm::dquat& rotation, double units_per_m);

/// Returns the plane of voxels `plane` through a point, converted to the device's frame.
PlaneHold plane_of(TouchPlane plane, const glm::dvec3& point, const Workspace& workspace, uint32_t count);
/// Returns the point nearest to `point` in the plane of voxels `plane` that contains the point `on`.
glm::dvec3 in_plane(TouchPlane plane, const glm::dvec3& on, const glm::dvec3& point);

/// Returns the radius of a straight tube, through the centre of a ball, that fills `share` of the ball; null if no tube
/// does: share = 1 - (1 - (tube / ball)^2)^(3/2)
std::optional<double> radius_from_overlap(double share, double ball_radius);

/// The place where tools act.
struct ToolPlace {
    glm::dvec3 point{0.0};              ///< volume space
    std::optional<uint32_t> node;       ///< the node that attracts tools
    std::optional<uint32_t> internode;  ///< the internode to which the tools snap, if they snap between its ends
};
/// Returns the place, within `reach`, to which tools snap as `feel` selects: the nearest node of the trace, or else the
/// nearest point of a centre line; if there is none, `point`. Tools never snap to groups that are not in `drawn`, nor
/// to internodes of `except_of`, the node from which the user continues.
ToolPlace tool_place(const FeelSettings& feel, const TraceGraph& trace, const glm::dvec3& point, double reach,
                     std::optional<uint32_t> except_of, const std::bitset<256>& drawn = EVERY_GROUP);

/// Returns the groups of the trace that actions at the probe can find: those shown, or all if hidden parts are felt.
std::bitset<256> groups_found_nearby(const Session& session);

}  // namespace shvr::ui
