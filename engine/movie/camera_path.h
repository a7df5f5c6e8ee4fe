#pragma once
// The way of a camera between two views, and around a volume. Pure functions; any thread. Lengths are in physical units
// of the volume, angles in degrees.

#include "engine/look/camera.h"

namespace shvr {

/// Returns 3 s^2 - 2 s^3, which begins and ends without speed. `share`: 0 ... 1.
double eased(double share);

/// Returns the camera at `share` (0 ... 1) of the way between two cameras of the same projection; at 0 and 1 exactly
/// `from` and `to`.
///
///   target               moves on the straight line
///   direction and up     turn together about one axis, the shortest way. A half turn, which has two shortest ways,
///                        moves the eye to its right, or up if the axis is horizontal in the picture
///   distance, height     change by equal factors in equal shares
///   angle of view, clip planes, shift    change linearly; a missing far clip plane counts as behind the whole volume
Camera camera_between(const Camera& from, const Camera& to, double share, const VolumeInfo& volume);

/// Returns the axis of the volume (x, y or z, either sign) that is closest to the camera's upward direction; of equally
/// close ones z, then y.
glm::dvec3 turntable_axis(const Camera& camera);
/// Turns the camera about the line through its target along `axis`, which has unit length. Along an axis that points
/// upwards, the eye moves to its right.
Camera turned(const Camera& camera, const glm::dvec3& axis, double degrees);

}  // namespace shvr
