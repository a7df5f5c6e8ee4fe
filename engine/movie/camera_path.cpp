#include "engine/movie/camera_path.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "engine/look/camera_motion.h"

namespace shvr {

namespace {

/// Real part of a rotation's quaternion below which the rotation counts as a half turn.
constexpr double HALF_TURN = 1e-9;

struct Turn {
    glm::dvec3 axis{0.0, 0.0, 1.0};
    double angle = 0.0;  ///< radians, 0 ... pi
};

glm::dquat orientation_of(const CameraAxes& axes)
{
    return glm::quat_cast(glm::dmat3(axes.right, axes.up, -axes.forward));
}

/// Returns the shortest rotation from one orientation to another.
Turn turn_between(const CameraAxes& from, const CameraAxes& to)
{
    glm::dquat turn = glm::normalize(orientation_of(to) * glm::conjugate(orientation_of(from)));
    if (turn.w < 0.0) turn = -turn;
    glm::dvec3 imaginary(turn.x, turn.y, turn.z);
    const double length = glm::length(imaginary);
    if (!(length > 0.0)) return {};
    if (turn.w < HALF_TURN) {
        const double to_right = glm::dot(imaginary, from.up), to_top = -glm::dot(imaginary, from.right);
        const double way = std::abs(to_right) > HALF_TURN ? to_right : to_top;
        if (way < 0.0) imaginary = -imaginary;
    }
    return {imaginary / length, 2.0 * std::atan2(length, turn.w)};
}

double by_factors(double from, double to, double share)
{
    return from == to ? from : from * std::pow(to / from, share);
}

/// Returns the distance of the far clip plane; without one, that of a plane behind the whole volume.
double far_plane_of(const Camera& camera, const VolumeInfo& volume)
{
    if (camera.far_distance > 0.0) return camera.far_distance;
    const glm::dvec3 diagonal = glm::dvec3(volume.size) * volume.spacing;
    return glm::distance(camera.eye, 0.5 * diagonal) + 0.5 * glm::length(diagonal);
}

}  // namespace

double eased(double share)
{
    return share * share * (3.0 - 2.0 * share);
}

Camera camera_between(const Camera& from, const Camera& to, double share, const VolumeInfo& volume)
{
    if (share <= 0.0 || from == to) return from;
    if (share >= 1.0) return to;
    const CameraAxes begin = axes_of(from);
    const Turn turn = turn_between(begin, axes_of(to));
    const glm::dquat rotation = glm::angleAxis(share * turn.angle, turn.axis);
    Camera camera = from;
    camera.target = glm::mix(from.target, to.target, share);
    const double distance = by_factors(glm::distance(from.eye, from.target), glm::distance(to.eye, to.target), share);
    camera.eye = camera.target - rotation * begin.forward * distance;
    camera.up = rotation * begin.up;
    camera.height = by_factors(from.height, to.height, share);
    camera.fov_y_degrees = std::lerp(from.fov_y_degrees, to.fov_y_degrees, share);
    camera.near_distance = std::lerp(from.near_distance, to.near_distance, share);
    if (from.far_distance > 0.0 || to.far_distance > 0.0)
        camera.far_distance = std::lerp(far_plane_of(from, volume), far_plane_of(to, volume), share);
    camera.shift_right = std::lerp(from.shift_right, to.shift_right, share);
    return camera;
}

glm::dvec3 turntable_axis(const Camera& camera)
{
    const glm::dvec3 up = axes_of(camera).up;
    int closest = 2;
    for (const int axis : {1, 0})
        if (std::abs(up[axis]) > std::abs(up[closest]) + HALF_TURN) closest = axis;
    glm::dvec3 result(0.0);
    result[closest] = up[closest] < 0.0 ? -1.0 : 1.0;
    return result;
}

Camera turned(const Camera& camera, const glm::dvec3& axis, double degrees)
{
    if (degrees == 0.0) return camera;
    const glm::dquat rotation = glm::angleAxis(radians(degrees), axis);
    Camera result = camera;
    result.eye = camera.target + rotation * (camera.eye - camera.target);
    result.up = rotation * camera.up;
    return result;
}

}  // namespace shvr
