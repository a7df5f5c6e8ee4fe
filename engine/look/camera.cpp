#include "engine/look/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/finite.h"

namespace shvr {
namespace {

constexpr double FIT_FOV_DEGREES = 30.0;
constexpr double FIT_MARGIN = 1.05;
/// Sine of the minimum angle between `up` and the view direction; below it, the picture's vertical is undefined.
constexpr double MIN_UP_SINE = 1e-6;
/// Distance of the near plane from a perspective eye inside the volume, in units of the finest spacing (`ray_planes`).
constexpr double NEAR_HAIR = 1e-6;

struct Side {
    const char* name;
    glm::dvec3 back;  ///< direction from the volume's centre towards the eye
    glm::dvec3 up;
};
constexpr Side SIDES[] = {
    {"front", {0, -1, 0}, {0, 0, 1}}, {"back", {0, 1, 0}, {0, 0, 1}}, {"left", {-1, 0, 0}, {0, 0, 1}},
    {"right", {1, 0, 0}, {0, 0, 1}},  {"top", {0, 0, 1}, {0, 1, 0}},  {"bottom", {0, 0, -1}, {0, 1, 0}},
};

struct Sphere {
    glm::dvec3 centre;  ///< volume space
    double radius;
};

Sphere bounding_sphere(const VolumeInfo& volume)
{
    const glm::dvec3 diagonal = glm::dvec3(volume.size) * volume.spacing;
    return {0.5 * diagonal, 0.5 * glm::length(diagonal)};
}

std::string shown(const glm::dvec3& v)
{
    return sentence("(", v.x, ", ", v.y, ", ", v.z, ")");
}

/// The camera's axes, right-handed and of unit length: right x up = -forward.
struct Axes {
    glm::dvec3 right, up, forward;
};

/// Returns the camera's axes; null if its vectors do not determine them.
std::optional<Axes> frame_of(const Camera& camera)
{
    const glm::dvec3 view = camera.target - camera.eye;
    const double view_length = glm::length(view);
    const double up_length = glm::length(camera.up);
    if (!(view_length > 0.0) || !(up_length > 0.0) || !std::isfinite(view_length) || !std::isfinite(up_length))
        return {};
    const glm::dvec3 forward = view / view_length;
    const glm::dvec3 right = glm::cross(forward, camera.up / up_length);
    const double sine = glm::length(right);
    if (!(sine >= MIN_UP_SINE)) return {};
    return Axes{right / sine, glm::cross(right / sine, forward), forward};
}

struct Plane {
    glm::dvec3 corner, dx, dy;
};

/// Returns the pixel grid, in voxel space, whose centre is `shift_right` to the right of `middle` (in volume space).
Plane pixel_plane(const glm::dvec3& middle, double pixel, const Axes& axes, const glm::uvec2& pixels,
                  double shift_right, const glm::dvec3& spacing)
{
    const double to_left = 0.5 * pixel * pixels.x - shift_right * pixel * pixels.y;
    const glm::dvec3 corner = middle + axes.up * (0.5 * pixel * pixels.y) - axes.right * to_left;
    return {corner / spacing, axes.right * pixel / spacing, -axes.up * pixel / spacing};
}

Camera camera_of_view(const SideView& view, const VolumeInfo& volume)
{
    const auto side = std::ranges::find(SIDES, view.side, &Side::name);
    if (side == std::end(SIDES)) {
        std::string names;
        for (const Side& known : SIDES) names += sentence(names.empty() ? "" : ", ", known.name);
        fail("camera side is \"", view.side, "\"; expected one of ", names);
    }
    const double turn = radians(view.turn_degrees);
    const double tilt = radians(view.tilt_degrees);
    const glm::dvec3 right = glm::cross(side->up, side->back);
    const glm::dvec3 turned = side->back * std::cos(turn) + right * std::sin(turn);
    const glm::dvec3 back = turned * std::cos(tilt) + side->up * std::sin(tilt);
    const glm::dvec3 up = side->up * std::cos(tilt) - turned * std::sin(tilt);

    const Sphere sphere = bounding_sphere(volume);
    const double distance = FIT_MARGIN * sphere.radius / std::sin(radians(0.5 * FIT_FOV_DEGREES)) / view.zoom;
    Camera camera;
    camera.eye = sphere.centre + back * distance;
    camera.target = sphere.centre;
    camera.up = up;
    camera.fov_y_degrees = FIT_FOV_DEGREES;
    camera.height = 2.0 * FIT_MARGIN * sphere.radius / view.zoom;
    return camera;
}

}  // namespace

glm::dvec4 depth_plane(const Camera& camera, const glm::dvec3& lower, const glm::dvec3& upper,
                       const glm::dvec3& spacing)
{
    std::array<glm::dvec3, 8> corners;
    for (int corner = 0; corner < 8; ++corner)
        corners[size_t(corner)] = glm::mix(lower, upper, glm::bvec3(corner & 1, corner & 2, corner & 4));
    return depth_plane(camera, corners, spacing);
}

glm::dvec4 depth_plane(const Camera& camera, std::span<const glm::dvec3> corners, const glm::dvec3& spacing)
{
    check_camera(camera);
    const glm::dvec3 forward = frame_of(camera)->forward;
    double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
    for (const glm::dvec3& corner : corners) {
        const double depth = glm::dot(corner * spacing - camera.eye, forward);
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    const bool is_perspective = camera.projection == Camera::Projection::perspective;
    if (is_perspective || camera.near_distance > 0.0) nearest = std::max(nearest, camera.near_distance);
    const double extent = farthest - nearest;
    if (!(extent > 0.0)) return glm::dvec4(0.0);
    return {forward * spacing / extent, -(glm::dot(camera.eye, forward) + nearest) / extent};
}

void check_camera(const Camera& camera)
{
    if (!is_finite(camera.eye) || !is_finite(camera.target) || !is_finite(camera.up))
        fail("camera: eye ", shown(camera.eye), ", target ", shown(camera.target), " or up ", shown(camera.up),
             " is not finite; expected three finite numbers for each");
    if (camera.projection == Camera::Projection::perspective &&
        !(camera.fov_y_degrees > 0.0 && camera.fov_y_degrees < 180.0))
        fail("camera: the vertical field of view is ", camera.fov_y_degrees,
             " degrees; expected more than 0 and less than 180");
    if (camera.projection == Camera::Projection::orthographic && !(camera.height > 0.0 && std::isfinite(camera.height)))
        fail("camera: the height is ", camera.height, "; expected a number above 0");
    if (!(camera.near_distance >= 0.0 && std::isfinite(camera.near_distance)) ||
        !(camera.far_distance >= 0.0 && std::isfinite(camera.far_distance)))
        fail("camera: the clip planes are at ", camera.near_distance, " and ", camera.far_distance,
             "; expected finite distances of 0 or more");
    if (!std::isfinite(camera.shift_right))
        fail("camera: shift_right is ", camera.shift_right, "; expected a finite number of view heights");
    if (camera.eye == camera.target)
        fail("camera: eye and target are both ", shown(camera.eye), "; expected two different points");
    if (!frame_of(camera))
        fail("camera: up is ", shown(camera.up), " and the view goes from ", shown(camera.eye), " to ",
             shown(camera.target), "; expected an up that is neither zero nor parallel to the view direction");
}

RayPlanes ray_planes(const Camera& camera, const glm::uvec2& pixels, const VolumeInfo& volume)
{
    SHVR_CHECK(pixels.x > 0 && pixels.y > 0, pixels.x, " x ", pixels.y);
    check_camera(camera);
    const Axes axes = *frame_of(camera);
    const Sphere sphere = bounding_sphere(volume);
    const bool is_perspective = camera.projection == Camera::Projection::perspective;

    // Points on the view axis, the line through eye and target, are computed from the eye or the target, whichever is
    // closer to the volume, since the coordinates of a point far away are rounded more coarsely.
    const bool anchor_is_eye = glm::distance(camera.eye, sphere.centre) <= glm::distance(camera.target, sphere.centre);
    const glm::dvec3 anchor = anchor_is_eye ? camera.eye : camera.target;
    const double anchor_depth = anchor_is_eye ? 0.0 : glm::distance(camera.eye, camera.target);
    const double centre_offset = glm::dot(sphere.centre - anchor, axes.forward);

    // All following distances are along the view axis, measured from the anchor.
    const double hair =
        is_perspective ? NEAR_HAIR * std::min({volume.spacing.x, volume.spacing.y, volume.spacing.z}) : 0.0;
    const double clip_near = std::max(camera.near_distance, hair) - anchor_depth;
    const double clip_far =
        camera.far_distance > 0.0 ? camera.far_distance - anchor_depth : std::numeric_limits<double>::infinity();
    double near_offset = std::max(centre_offset - sphere.radius, clip_near);
    double far_offset = std::min(centre_offset + sphere.radius, clip_far);
    const bool empty = !(near_offset < far_offset);
    if (empty) {
        near_offset = clip_near;
        far_offset = clip_near + 2.0 * sphere.radius;
    }

    const double per_depth = 2.0 * std::tan(radians(0.5 * camera.fov_y_degrees)) / pixels.y;
    const auto plane_at = [&](double offset) {
        const double pixel = is_perspective ? per_depth * (anchor_depth + offset) : camera.height / pixels.y;
        return pixel_plane(anchor + axes.forward * offset, pixel, axes, pixels, camera.shift_right, volume.spacing);
    };
    const Plane near_plane = plane_at(near_offset);
    const Plane far_plane = plane_at(far_offset);
    const auto share = [&](double offset) { return (offset - near_offset) / (far_offset - near_offset); };
    const double target_offset = glm::distance(camera.eye, camera.target) - anchor_depth;
    const RayPlanes planes{near_plane.corner,
                           near_plane.dx,
                           near_plane.dy,
                           far_plane.corner,
                           far_plane.dx,
                           far_plane.dy,
                           empty,
                           share(clip_near),
                           share(std::clamp(target_offset, near_offset, far_offset)),
                           share(clip_far)};
    if (!is_finite(planes.near_corner) || !is_finite(planes.far_corner) || !is_finite(planes.far_dx) ||
        !is_finite(planes.far_dy))
        fail("camera: eye ", shown(camera.eye),
             " is so far away that rays have no finite coordinates; expected it closer to the volume");
    return planes;
}

Camera camera_looking(const std::string& side, const VolumeInfo& volume)
{
    return camera_of_view({.side = side}, volume);
}

std::vector<std::string> camera_sides()
{
    std::vector<std::string> names;
    for (const Side& side : SIDES) names.emplace_back(side.name);
    return names;
}

std::string side_of_largest_face(const VolumeInfo& volume)
{
    const glm::dvec3 extent = glm::dvec3(volume.size) * volume.spacing;
    // Two faces share one side, so the ratio of their areas is the ratio of their other sides, without an overflow.
    const bool right_is_larger = extent.y > 2.0 * extent.x, top_is_larger = extent.y > 2.0 * extent.z;
    if (!right_is_larger && !top_is_larger) return "front";
    return extent.z >= extent.x ? "right" : "top";
}

Camera camera_of(const CameraSpec& spec, const VolumeInfo& volume)
{
    if (const auto* view = std::get_if<SideView>(&spec)) return camera_of_view(*view, volume);
    return std::get<Camera>(spec);
}

}  // namespace shvr
