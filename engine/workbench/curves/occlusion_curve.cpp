#include "engine/workbench/curves/occlusion_curve.h"

#include <algorithm>
#include <cmath>

namespace shvr::ui {

OcclusionPoints points_of_power(double power)
{
    OcclusionPoints points;
    for (const double arrives : {0.0, 0.25, 0.5, 0.75, 1.0}) points.push_back({arrives, std::pow(arrives, power)});
    return points;
}

std::optional<size_t> point_under(const OcclusionPoints& points, const glm::dvec2& place, const glm::dvec2& reach)
{
    std::optional<size_t> found;
    double nearest = 1.0;
    for (size_t i = 0; i < points.size(); ++i) {
        const double away = glm::length((glm::dvec2(points[i].arrives, points[i].seen) - place) / reach);
        if (away > nearest) continue;
        nearest = away;
        found = i;
    }
    return found;
}

OcclusionPoints moved(OcclusionPoints points, size_t point, const OcclusionPoint& to)
{
    const double lower = point == 0 ? 0.0 : points[point - 1].arrives;
    const double upper = point + 1 == points.size() ? 1.0 : points[point + 1].arrives;
    points[point] = {std::clamp(to.arrives, lower, upper), std::clamp(to.seen, 0.0, 1.0)};
    return points;
}

size_t add(OcclusionPoints& points, const OcclusionPoint& point)
{
    const auto at =
        std::ranges::upper_bound(points, point.arrives, {}, [](const OcclusionPoint& each) { return each.arrives; });
    const auto index = size_t(at - points.begin());
    if (points.size() == MAX_OCCLUSION_POINTS) return std::min(index, points.size() - 1);
    points.insert(at, {std::clamp(point.arrives, 0.0, 1.0), std::clamp(point.seen, 0.0, 1.0)});
    return index;
}

OcclusionPoints without(OcclusionPoints points, size_t point)
{
    if (points.size() > 2) points.erase(points.begin() + std::ptrdiff_t(point));
    return points;
}

OcclusionPoint in_widest_gap(const OcclusionPoints& points)
{
    double begin = 0.0, end = 0.0, last = 0.0;
    const auto look_at = [&](double next) {
        if (next - last > end - begin) {
            begin = last;
            end = next;
        }
        last = next;
    };
    for (const OcclusionPoint& point : points) look_at(point.arrives);
    look_at(1.0);
    const double arrives = 0.5 * (begin + end);
    return {arrives, seen_of({.mapping = points}, arrives)};
}

}  // namespace shvr::ui
