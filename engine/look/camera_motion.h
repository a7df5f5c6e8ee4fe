#pragma once
// Moves cameras, and converts between points and pixels. Pure functions; any thread. Lengths are in physical units of
// the volume, angles in degrees. In pixel coordinates, x is to the right, y is down, and pixel centres are at + 0.5.

#include <optional>

#include "engine/look/camera.h"

namespace shvr {

/// A right-handed orthonormal basis: right x up = -forward.
struct CameraAxes {
    glm::dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
};
/// Fails as check_camera does.
CameraAxes axes_of(const Camera& camera);

/// Rotates eye and target about `pivot`, to the right and up as the camera sees these directions.
Camera orbited(const Camera& camera, const glm::dvec3& pivot, double right_degrees, double up_degrees);
/// Rotates the view about its own axis, clockwise for the viewer.
Camera rolled(const Camera& camera, double degrees);
/// Moves eye and target along the camera's right, up and forward axes.
Camera moved(const Camera& camera, const glm::dvec3& right_up_forward);
/// Zooms by `factor` (above 1: closer). The point that `pixel` shows at the target's depth stays at that pixel.
Camera zoomed(const Camera& camera, const glm::uvec2& pixels, const glm::dvec2& pixel, double factor);

/// Returns a camera that looks in the same direction at the centre of a box (volume space) and shows the whole box,
/// with a margin of 5 %. The clip planes stay in place.
Camera fitted(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& lower, const glm::dvec3& upper);
/// Returns a camera that looks at another point in the same direction. The distance and the clip planes stay unchanged.
Camera looking_at(const Camera& camera, const glm::dvec3& target);
/// Returns the camera that sees the same voxels when the volume's spacing becomes `ratio` times the old one. The match
/// is exact along the view and upwards; to the right, only if the ratio is equal along all axes.
Camera respaced(const Camera& camera, const glm::dvec3& ratio);

/// The projection of a point: its pixel coordinates, and its distance from the eye along the view direction. Null, for
/// a perspective camera, if the point is level with the eye or behind it.
struct Projected {
    glm::dvec2 pixel{0.0};
    double depth = 0.0;
};
std::optional<Projected> project(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& point);
/// Returns the point that is shown at a pixel, at this depth.
glm::dvec3 unproject(const Camera& camera, const glm::uvec2& pixels, const glm::dvec2& pixel, double depth);
/// Returns the size of a pixel at this depth, in physical units.
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
/// Returns the pixels that may show parts of a box (volume space), with a margin of one pixel; all pixels if the box
/// reaches behind the eye.
PixelBox pixels_of_box(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& lower,
                       const glm::dvec3& upper);
/// The same for a ball.
PixelBox pixels_of_ball(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& center, double radius);

}  // namespace shvr
