#include "engine/movie/look_between.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace shvr {

namespace {

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr glm::dvec3 OVER_THE_SHOULDER{0.3, 0.5, 1.0};  ///< what light.direction 0, 0, 0 means

/// Stays between both, unlike sums of products.
double mixed(double from, double to, double share)
{
    return std::lerp(from, to, share);
}

glm::dvec3 mixed(const glm::dvec3& from, const glm::dvec3& to, double share)
{
    return {mixed(from.x, to.x, share), mixed(from.y, to.y, share), mixed(from.z, to.z, share)};
}

/// The look of a function at an intensity; outside of its range it has no colour.
struct LookAt {
    glm::dvec3 color{0.0};
    double opacity = 0.0;
    bool is_outside = false;
};

/// Returns the look just below (-1), at (0) or just above (1) an intensity.
LookAt beside(const TransferFunction& function, double intensity, int where)
{
    const double at = where == 0 ? intensity : std::nextafter(intensity, where * INFINITE);
    const glm::dvec4 look = function.at(at);
    return {glm::dvec3(look), look.a, at < function.lower() || at > function.upper()};
}

/// Returns the point of two mixed functions. A colour counts by the opacity that it has.
ControlPoint mixed_at(double intensity, const LookAt& from, const LookAt& to, double share)
{
    const double of_from = from.opacity * (1.0 - share), of_to = to.opacity * share, sum = of_from + of_to;
    double of_color = sum > 0.0 ? of_to / sum : share;
    if (from.is_outside != to.is_outside) of_color = from.is_outside ? 1.0 : 0.0;
    return {intensity, mixed(from.color, to.color, of_color), std::min(sum, 1.0)};
}

/// Whether two points of adjacent intensities differ by more than a slope.
bool steps(const ControlPoint& lower, const ControlPoint& upper)
{
    constexpr double SLOPE = 1e-9;
    return std::abs(lower.opacity - upper.opacity) > SLOPE || glm::distance(lower.color, upper.color) > SLOPE;
}

TransferFunction mixed_functions(const TransferFunction& from, const TransferFunction& to, double share)
{
    std::set<double> intensities;
    for (const TransferFunction* function : {&from, &to})
        for (const ControlPoint& point : function->points()) intensities.insert(point.intensity);
    std::vector<ControlPoint> points;
    for (const double intensity : intensities) {
        const auto look = [&](double at, int where) {
            return mixed_at(at, beside(from, intensity, where), beside(to, intensity, where), share);
        };
        // A function may step here; each begins and ends with a step. The last point at an intensity applies to the
        // intensity itself, so what lies above it begins at the next number.
        const ControlPoint below = look(intensity, -1), here = look(intensity, 0);
        const ControlPoint above = look(std::nextafter(intensity, INFINITE), 1);
        if (intensity != *intensities.begin() && steps(below, here)) points.push_back(below);
        points.push_back(here);
        if (intensity != *intensities.rbegin() && steps(here, above)) points.push_back(above);
    }
    return TransferFunction(std::move(points));
}

std::optional<glm::dvec3> mixed_colors(const std::optional<glm::dvec3>& from, const std::optional<glm::dvec3>& to,
                                       const glm::dvec3& otherwise, double share)
{
    if (from == to) return from;
    return mixed(from.value_or(otherwise), to.value_or(otherwise), share);
}

DistanceBlend blend_between(const DistanceBlend& from, const DistanceBlend& to, const glm::dvec3& background,
                            double share)
{
    if (from == to) return from;
    DistanceBlend blend = from.size > 0.0 ? from : to;
    blend.size = mixed(from.size, to.size, share);
    if (from.size == 0.0 || to.size == 0.0) return blend;  // only one of them has a rate and a colour that show
    blend.rate = mixed(from.rate, to.rate, share);
    blend.color = mixed_colors(from.color, to.color, background, share);
    return blend;
}

Unpainted unpainted_between(const Unpainted& from, const Unpainted& to, double share)
{
    if (from == to) return from;
    const auto opacity = [](const Unpainted& voxels) { return voxels.visible ? voxels.opacity : 0.0; };
    return {from.visible || to.visible, mixed(opacity(from), opacity(to), share)};
}

}  // namespace

TransferFunction function_between(const TransferFunction& from, const TransferFunction& to, double share)
{
    if (share <= 0.0 || from == to) return from;
    if (share >= 1.0) return to;
    if (from.points().size() != to.points().size()) return mixed_functions(from, to, share);
    std::vector<ControlPoint> points(from.points().begin(), from.points().end());
    for (size_t i = 0; i < points.size(); ++i) {
        const ControlPoint& end = to.points()[i];
        points[i] = {mixed(points[i].intensity, end.intensity, share), mixed(points[i].color, end.color, share),
                     mixed(points[i].opacity, end.opacity, share)};
    }
    return TransferFunction(std::move(points));
}

CutBox cut_between(const CutBox& from, const CutBox& to, double share, const VolumeInfo& volume)
{
    if (share <= 0.0 || from == to) return from;
    if (share >= 1.0) return to;
    const glm::dvec3 size(volume.size);
    const auto inside = [&](const glm::dvec3& corner) { return glm::clamp(corner, glm::dvec3(0.0), size); };
    CutBox cut{mixed(inside(from.lower), inside(to.lower), share), mixed(inside(from.upper), inside(to.upper), share)};
    if (!from.plane_normal && !to.plane_normal) return cut;
    // A plane that is in one of the two only comes from the volume's far end, or goes there.
    const auto whole = [&](const CutBox& other) {
        const glm::dvec3 along = glm::normalize(*other.plane_normal);
        CutBox away;
        away.plane_normal = along;
        away.plane_point = glm::dvec3(along.x > 0.0, along.y > 0.0, along.z > 0.0) * size;
        return away;
    };
    const CutBox begin = from.plane_normal ? from : whole(to), end = to.plane_normal ? to : whole(from);
    const glm::dvec3 between = mixed(glm::normalize(*begin.plane_normal), glm::normalize(*end.plane_normal), share);
    // Opposite directions have none half-way.
    cut.plane_normal = glm::length(between) > 1e-3 ? between : glm::normalize(*begin.plane_normal);
    cut.plane_point = mixed(begin.plane_point.value_or(0.5 * size), end.plane_point.value_or(0.5 * size), share);
    return cut;
}

Groups groups_between(const Groups& from, const Groups& to, double share)
{
    if (share <= 0.0 || from == to) return from;
    if (share >= 1.0) return to;
    Groups groups;
    for (const Groups* of : {&from, &to})
        for (const auto& [group, settings] : *of) groups[group] = settings;
    for (auto& [group, settings] : groups) {
        const ColorGroup a = group_of(from, group), b = group_of(to, group);
        if (parent_of(from, group) != parent_of(to, group)) settings.parent = 0;
        settings.color = mixed(a.color, b.color, share);
        settings.opacity = mixed(a.visible ? a.opacity : 0.0, b.visible ? b.opacity : 0.0, share);
        settings.visible = a.visible || b.visible;
    }
    return groups;
}

Light light_between(const Light& from, const Light& to, double share)
{
    if (share <= 0.0 || from == to) return from;
    if (share >= 1.0) return to;
    const auto direction = [](const Light& light) {
        return glm::normalize(light.direction == glm::dvec3(0.0) ? OVER_THE_SHOULDER : light.direction);
    };
    Light light = from;
    light.ambient = mixed(from.ambient, to.ambient, share);
    light.diffuse = mixed(from.diffuse, to.diffuse, share);
    light.specular = mixed(from.specular, to.specular, share);
    light.shininess = mixed(from.shininess, to.shininess, share);
    light.gradient_fade = mixed(from.gradient_fade, to.gradient_fade, share);
    light.occlusion.strength = mixed(from.occlusion.strength, to.occlusion.strength, share);
    light.occlusion.radius = mixed(from.occlusion.radius, to.occlusion.radius, share);
    if (from.direction != to.direction) {
        const glm::dvec3 between = mixed(direction(from), direction(to), share);
        if (glm::length(between) > 1e-3) light.direction = between;  // opposite directions have none half-way
    }
    return light;
}

Session session_between(const Session& from, const Session& to, double share, const VolumeInfo& volume)
{
    if (share >= 1.0) return to;
    Session session = from;
    if (share <= 0.0) return session;
    session.transfer_function = function_between(from.transfer_function, to.transfer_function, share);
    session.groups = groups_between(from.groups, to.groups, share);
    session.unpainted = unpainted_between(from.unpainted, to.unpainted, share);
    session.light = light_between(from.light, to.light, share);
    session.blend = blend_between(from.blend, to.blend, glm::dvec3(from.render.background), share);
    session.cut = cut_between(from.cut, to.cut, share, volume);
    return session;
}

}  // namespace shvr
