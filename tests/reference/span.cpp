#include "tests/reference/span.h"

#include <algorithm>

#include "tests/reference/field.h"

namespace shvr::reference {

std::optional<Interval> clip_to_box(const Ray& ray, const glm::dvec3& lower, const glm::dvec3& upper)
{
    Interval inside{ray.t_min, ray.t_max};
    for (int axis = 0; axis < 3; ++axis) {
        if (lower[axis] > upper[axis]) return std::nullopt;
        if (ray.direction[axis] == 0.0) {
            if (ray.origin[axis] < lower[axis] || ray.origin[axis] > upper[axis]) return std::nullopt;
            continue;
        }
        const double t_lower = (lower[axis] - ray.origin[axis]) / ray.direction[axis];
        const double t_upper = (upper[axis] - ray.origin[axis]) / ray.direction[axis];
        inside.lower = std::max(inside.lower, std::min(t_lower, t_upper));
        inside.upper = std::min(inside.upper, std::max(t_lower, t_upper));
    }
    if (!(inside.lower <= inside.upper)) return std::nullopt;
    return inside;
}

std::optional<Interval> clip_to_plane(const Ray& ray, const glm::dvec4& plane, Interval inside)
{
    const glm::dvec3 normal(plane);
    const double beyond = glm::dot(normal, ray.origin) + plane.w, rate = glm::dot(normal, ray.direction);
    if (rate == 0.0) return beyond > 0.0 ? std::nullopt : std::optional(inside);
    double& end = rate > 0.0 ? inside.upper : inside.lower;
    end = rate > 0.0 ? std::min(end, -beyond / rate) : std::max(end, -beyond / rate);
    if (!(inside.lower <= inside.upper)) return std::nullopt;
    return inside;
}

std::optional<Span> span_of(const Scene& scene, const Ray& ray)
{
    const glm::dvec3 physical = ray.direction * scene.spacing;
    const double length_of_t = glm::length(physical) / reference_length(scene);
    if (!(length_of_t > 0.0)) return std::nullopt;
    const glm::dvec3 lower = glm::max(scene.cut_min, glm::dvec3(0.0));
    const glm::dvec3 upper = glm::min(scene.cut_max, glm::dvec3(scene.size));
    std::optional<Interval> inside = clip_to_box(ray, lower, upper);
    if (inside) inside = clip_to_plane(ray, scene.cut_plane, *inside);
    if (!inside) return std::nullopt;
    return Span{.entry = ray.origin + inside->lower * ray.direction,
                .step = ray.direction / length_of_t,
                .length = (inside->upper - inside->lower) * length_of_t,
                .to_eye = -physical / glm::length(physical)};
}

}  // namespace shvr::reference
