#pragma once
// Camera motion, and conversion between points and pixels. Pure; any thread. Lengths are in physical units of the
// volume, angles in degrees. In pixel coordinates, x points right, y points down, and pixel centres are at + 0.5.

#include <optional>

#include "engine/look/camera.h"

namespace shvr {

/// A right-handed orthonormal basis: right x up = -forward.
struct CameraAxes {
    glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
};
/// Fails as check_camera does.
CameraAxes axes_of(const Camera& camera);

/// Orbits the eye about `pivot`, to the right and up as seen from the camera; the target orbits with the eye.
Camera orbited(const Camera& camera, const glm::dvec3& pivot, double right_degrees, double up_degrees);
/// Rolls the view about its own axis, clockwise for the viewer.
Camera rolled(const Camera& camera, double degrees);
/// Moves eye and target along the camera's right, up and forward.
Camera moved(const Camera& camera, const glm::dvec3& right_up_forward);
/// Scales the view by `factor` (above 1: closer) about the point that `pixel` shows at the target's depth.
Camera zoomed(const Camera& camera, const glm::uvec2& pixels, const glm::dvec2& pixel, double factor);

/// Returns a camera with the same direction that is aimed at the centre of a box (volume space) and shows all of the
/// box, with a margin of 5 %. Clip planes stay unchanged.
Camera fitted(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& lower, const glm::dvec3& upper);
/// Returns a camera with the same direction and distance that is aimed at another point. Clip planes stay unchanged.
Camera looking_at(const Camera& camera, const glm::dvec3& target);
/// Returns the camera that sees the same voxels when the volume's spacing is `ratio` times the old one. The match is
/// exact along the view and upwards; to the right, it is exact if the ratio is equal along all axes.
Camera respaced(const Camera& camera, const glm::dvec3& ratio);

/// The projection of a point: its pixel coordinates, and its distance from the eye along the view. For a perspective
/// camera, null for points level with the eye or behind it.
struct Projected {
    glm::dvec2 pixel{0.0};
    double depth = 0.0;
};
std::optional<Projected> project(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& point);
/// Returns the point at a pixel and a depth.
glm::dvec3 unproject(const Camera& camera, const glm::uvec2& pixels, const glm::dvec2& pixel, double depth);
/// Returns the size of a pixel at a depth.
double pixel_size(const Camera& camera, const glm::uvec2& pixels, double depth);

/// A half-open box of pixels. Empty unless `begin` is below `end` along both axes.
struct PixelBox {
    glm::uvec2 begin{0}, end{0};
    bool empty() const { return begin.x >= end.x || begin.y >= end.y; }
    uint64_t area() const { return empty() ? 0 : uint64_t(end.x - begin.x) * (end.y - begin.y); }
    bool operator==(const PixelBox&) const = default;
};
/// The smallest box around both.
PixelBox united(const PixelBox& a, const PixelBox& b);
/// Returns the pixels that may show parts of a box (volume space), with a margin of one pixel; the whole picture if the
/// box reaches behind the eye.
PixelBox pixels_of_box(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& lower,
                       const glm::dvec3& upper);
/// The same for a ball.
PixelBox pixels_of_ball(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& center, double radius);

}  // namespace shvr
