#include "engine/look/camera_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <glm/gtc/quaternion.hpp>

namespace shvr {

namespace {

bool is_perspective(const Camera& camera)
{
    return camera.projection == Camera::Projection::perspective;
}

/// Returns the pixel through which the line from eye to target passes.
glm::dvec2 axis_pixel(const Camera& camera, const glm::uvec2& pixels)
{
    return 0.5 * glm::dvec2(pixels) - glm::dvec2(camera.shift_right * pixels.y, 0.0);
}

PixelBox pixels_around(const Camera& camera, const glm::uvec2& pixels, std::span<const glm::dvec3> corners)
{
    glm::dvec2 lower(1e300), upper(-1e300);
    for (const glm::dvec3& corner : corners) {
        const std::optional<Projected> at = project(camera, pixels, corner);
        if (!at) return {glm::uvec2(0), pixels};
        lower = glm::min(lower, at->pixel);
        upper = glm::max(upper, at->pixel);
    }
    const glm::dvec2 size(pixels);
    return {glm::uvec2(glm::clamp(glm::floor(lower) - 1.0, glm::dvec2(0.0), size)),
            glm::uvec2(glm::clamp(glm::ceil(upper) + 1.0, glm::dvec2(0.0), size))};
}

}  // namespace

CameraAxes axes_of(const Camera& camera)
{
    check_camera(camera);
    const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    return {right, glm::cross(right, forward), forward};
}

Camera orbited(const Camera& camera, const glm::dvec3& pivot, double right_degrees, double up_degrees)
{
    const CameraAxes axes = axes_of(camera);
    const glm::dquat turn =
        glm::angleAxis(radians(right_degrees), axes.up) * glm::angleAxis(radians(-up_degrees), axes.right);
    Camera turned = camera;
    turned.eye = pivot + turn * (camera.eye - pivot);
    turned.target = pivot + turn * (camera.target - pivot);
    turned.up = turn * axes.up;
    return turned;
}

Camera rolled(const Camera& camera, double degrees)
{
    const CameraAxes axes = axes_of(camera);
    Camera turned = camera;
    turned.up = glm::angleAxis(radians(-degrees), axes.forward) * axes.up;
    return turned;
}

Camera moved(const Camera& camera, const glm::dvec3& right_up_forward)
{
    const CameraAxes axes = axes_of(camera);
    const glm::dvec3 way =
        axes.right * right_up_forward.x + axes.up * right_up_forward.y + axes.forward * right_up_forward.z;
    Camera result = camera;
    result.eye += way;
    result.target += way;
    return result;
}

Camera zoomed(const Camera& camera, const glm::uvec2& pixels, const glm::dvec2& pixel, double factor)
{
    const double depth = glm::distance(camera.eye, camera.target);
    const glm::dvec3 fixed = unproject(camera, pixels, pixel, depth);
    Camera result = camera;
    result.eye = fixed + (camera.eye - fixed) / factor;
    result.target = fixed + (camera.target - fixed) / factor;
    result.height = camera.height / factor;
    return result;
}

namespace {

/// Changes the clip distances of `is`, so that its planes stay where those of `was` are. Both look along `forward`.
void keep_clip_planes(const Camera& was, Camera& is, const glm::dvec3& forward)
{
    const double way = glm::dot(was.eye - is.eye, forward);
    if (was.near_distance > 0.0) is.near_distance = std::max(0.0, was.near_distance + way);
    if (was.far_distance > 0.0)
        is.far_distance = std::max(1e-6 * glm::distance(is.eye, is.target), was.far_distance + way);
}

}  // namespace

Camera looking_at(const Camera& camera, const glm::dvec3& target)
{
    Camera result = camera;
    result.eye = target + (camera.eye - camera.target);
    result.target = target;
    keep_clip_planes(camera, result, axes_of(camera).forward);
    return result;
}

Camera respaced(const Camera& camera, const glm::dvec3& ratio)
{
    const CameraAxes axes = axes_of(camera);
    Camera result = camera;
    result.eye = camera.eye * ratio;
    result.target = camera.target * ratio;
    result.up = glm::normalize(axes.up * ratio);
    const double along = glm::length(axes.forward * ratio);
    result.near_distance = camera.near_distance * along;
    result.far_distance = camera.far_distance * along;
    result.height = camera.height * glm::length(axes.up * ratio);
    return result;
}

Camera fitted(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& lower, const glm::dvec3& upper)
{
    constexpr double MARGIN = 1.05;
    const CameraAxes axes = axes_of(camera);
    const glm::dvec3 center = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
    const double aspect = double(std::max(pixels.x, 1u)) / double(std::max(pixels.y, 1u));
    const double slope = std::tan(0.5 * radians(camera.fov_y_degrees));
    double distance = 0.0, height = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 at = half * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const double reach =
            MARGIN * std::max(std::abs(glm::dot(at, axes.up)), std::abs(glm::dot(at, axes.right)) / aspect);
        height = std::max(height, 2.0 * reach);
        distance = std::max(distance, reach / slope - glm::dot(at, axes.forward));
    }
    // The eye of an orthographic camera must also be outside of the box, since nothing behind the eye is visible.
    if (!is_perspective(camera)) distance = MARGIN * glm::length(half);
    Camera result = camera;
    result.target = center;
    result.eye = center - axes.forward * std::max(distance, 1e-6 * glm::distance(camera.eye, camera.target));
    result.height = height > 0.0 ? height : camera.height;
    keep_clip_planes(camera, result, axes.forward);
    return result;
}

std::optional<Projected> project(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& point)
{
    const CameraAxes axes = axes_of(camera);
    const glm::dvec3 from_eye = point - camera.eye;
    const double depth = glm::dot(from_eye, axes.forward);
    if (is_perspective(camera) && !(depth > 0.0)) return std::nullopt;
    const double size = pixel_size(camera, pixels, depth);
    const glm::dvec2 middle = axis_pixel(camera, pixels);
    return Projected{{middle.x + glm::dot(from_eye, axes.right) / size, middle.y - glm::dot(from_eye, axes.up) / size},
                     depth};
}

glm::dvec3 unproject(const Camera& camera, const glm::uvec2& pixels, const glm::dvec2& pixel, double depth)
{
    const CameraAxes axes = axes_of(camera);
    const glm::dvec2 offset = (pixel - axis_pixel(camera, pixels)) * pixel_size(camera, pixels, depth);
    return camera.eye + axes.forward * depth + axes.right * offset.x - axes.up * offset.y;
}

double pixel_size(const Camera& camera, const glm::uvec2& pixels, double depth)
{
    if (!is_perspective(camera)) return camera.height / pixels.y;
    return 2.0 * std::tan(radians(0.5 * camera.fov_y_degrees)) * depth / pixels.y;
}

PixelBox united(const PixelBox& a, const PixelBox& b)
{
    if (a.empty() || b.empty()) return a.empty() ? b : a;
    return {glm::min(a.begin, b.begin), glm::max(a.end, b.end)};
}

PixelBox pixels_of_box(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& lower, const glm::dvec3& upper)
{
    std::array<glm::dvec3, 8> corners;
    for (size_t i = 0; i < 8; ++i)
        corners[i] = {i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z};
    return pixels_around(camera, pixels, corners);
}

PixelBox pixels_of_ball(const Camera& camera, const glm::uvec2& pixels, const glm::dvec3& center, double radius)
{
    const CameraAxes axes = axes_of(camera);
    std::array<glm::dvec3, 8> corners;
    for (size_t i = 0; i < 8; ++i)
        corners[i] = center + radius * ((i & 1 ? 1.0 : -1.0) * axes.right + (i & 2 ? 1.0 : -1.0) * axes.up +
                                        (i & 4 ? 1.0 : -1.0) * axes.forward);
    return pixels_around(camera, pixels, corners);
}

}  // namespace shvr
