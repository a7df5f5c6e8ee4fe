#pragma once
// Cameras and their rays, computed in double precision on the CPU. The device gets two parallel planes of points close
// to the volume and connects them to rays, so that even a camera a million voxels away loses no accuracy.

#include <numbers>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "engine/base/spelling.h"
#include "engine/volume/volume.h"

namespace shvr {

inline double radians(double degrees)
{
    return degrees * (std::numbers::pi / 180.0);
}

struct Camera {
    enum class Projection { perspective, orthographic };
    Projection projection = Projection::perspective;
    glm::dvec3 eye{0.0, 0.0, 1.0};  ///< in volume space (physical units of the file)
    glm::dvec3 target{0.0};         ///< volume space
    glm::dvec3 up{0.0, 0.0, 1.0};   ///< not parallel to target - eye
    double fov_y_degrees = 30.0;    ///< perspective: full vertical angle
    double height = 1.0;            ///< orthographic: height of the view, physical units
    double near_distance = 0.0;     ///< near clip plane along the view direction, physical units
    double far_distance = 0.0;      ///< far clip plane; 0: none. Nothing behind the eye is visible
    /// For off-axis views (Bourke 1999, "Calculating stereo pairs"): shift of the picture's centre to the right of the
    /// line from eye to target, in units of the view's height, the same at every depth. The image plane stays
    /// perpendicular to that line.
    double shift_right = 0.0;
    bool operator==(const Camera&) const = default;
};
inline constexpr Spelling<Camera::Projection> PROJECTIONS[] = {{Camera::Projection::perspective, "perspective"},
                                                               {Camera::Projection::orthographic, "orthographic"}};
constexpr std::span<const Spelling<Camera::Projection>> spellings_of(Camera::Projection)
{
    return PROJECTIONS;
}

/// A view relative to the volume: from one of `camera_sides()`, then turned and tilted about the volume's centre.
struct SideView {
    std::string side = "front";
    double zoom = 1.0;          ///< divides the eye's distance
    double turn_degrees = 0.0;  ///< rotation about the view's vertical axis; the eye moves to its right
    double tilt_degrees = 0.0;  ///< elevation of the eye; at 90, the eye looks straight down
    bool operator==(const SideView&) const = default;
};

/// The camera as a session stores it: explicit numbers, or a view that is computed from the volume (`camera_of`).
using CameraSpec = std::variant<Camera, SideView>;

/// Rays in voxel space. The ray of pixel (x, y), with y down, starts at near_corner + x' * near_dx + y' * near_dy, with
/// x' = x + 0.5 and y' = y + 0.5 (pixel centres), and ends at the same expression of the far plane.
struct RayPlanes {
    glm::dvec3 near_corner, near_dx, near_dy;
    glm::dvec3 far_corner, far_dx, far_dy;
    bool empty =
        false;  ///< near plane behind far plane, or volume outside the clip range: nothing of the volume is visible
    // Positions along a ray, where 0 is the near plane and 1 the far plane. They may lie outside of the volume.
    double begin = 0.0;   ///< start of the camera's clip range; at most 0 unless `empty`
    double middle = 0.5;  ///< camera's target, or the nearer plane if the target is not between the planes
    double end = 1.0;     ///< end of the camera's clip range; infinite without a far clip plane
};

/// Returns planes perpendicular to the view direction. They touch the volume's bounding sphere, or lie at the clip
/// distances if those are tighter. For a perspective eye in or at the sphere, the near plane is 1e-6 of the finest
/// spacing in front of the eye. If the volume is outside the clip range, the planes lie inside that range, one diameter
/// of the sphere apart. Fails like `check_camera`.
RayPlanes ray_planes(const Camera& camera, const glm::uvec2& pixels, const VolumeInfo& volume);

/// Returns the plane p of normalized depth: for a voxel position, dot(p.xyz, voxel) + p.w is 0 where the box from
/// `lower` to `upper` begins in front of the eye or near clip plane, and 1 where it ends. Fails like `check_camera`.
glm::dvec4 depth_plane(const Camera& camera, const glm::dvec3& lower, const glm::dvec3& upper,
                       const glm::dvec3& spacing);
/// The same for the convex hull of `corners`, in voxels; 0 everywhere if there are none.
glm::dvec4 depth_plane(const Camera& camera, std::span<const glm::dvec3> corners, const glm::dvec3& spacing);

/// Fails if the camera is degenerate: eye at target, up parallel to the view, angle outside (0, 180), or not finite.
void check_camera(const Camera& camera);

/// Returns a camera that sees the whole volume from a side: "front" (the eye is on the -y side), "back" (+y), "left"
/// (-x) or "right" (+x), all with z up; "top" (+z) or "bottom" (-z) with y up. With a field of view of 30 degrees, the
/// bounding sphere fits into a square picture, with 5 % to spare.
Camera camera_looking(const std::string& side, const VolumeInfo& volume);
std::vector<std::string> camera_sides();
/// Returns the default side to look from: "front", unless another face has more than twice the front's area, as in a
/// stack of few slices. Then the largest face is used, "top" or "right" ("right" if both are equal, since z is up
/// there).
std::string side_of_largest_face(const VolumeInfo& volume);
Camera camera_of(const CameraSpec& spec, const VolumeInfo& volume);

}  // namespace shvr
