#include "engine/annotation/patterns/head_axis.h"

#include <algorithm>

namespace shvr {

namespace {

constexpr double AXIS_PLAY = 0.05;  ///< points further than this from their vein's plane have little weight
/// Weight of the sections' axis of symmetry, relative to the squared errors of the veins' points.
constexpr double SYMMETRY_WEIGHT = 4.0;

/// A vein's points relative to the axis, as (x, y, along), and the normal of the best-fitting plane through the axis.
struct AxialCourse {
    std::vector<glm::dvec3> points;
    glm::dvec2 normal{1.0, 0.0};
};

AxialCourse axial(const VeinCourse& course, const HeadAxis& axis)
{
    const auto [x, y] = across(axis.direction);
    AxialCourse made;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (const VeinPoint& point : course) {
        const glm::dvec3 p = point.at - axis.centre;
        const glm::dvec3 q(glm::dot(p, x), glm::dot(p, y), glm::dot(p, axis.direction));
        made.points.push_back(q);
        xx += point.length * q.x * q.x;
        xy += point.length * q.x * q.y;
        yy += point.length * q.y * q.y;
    }
    const double along = 0.5 * std::atan2(2.0 * xy, xx - yy);
    made.normal = {-std::sin(along), std::cos(along)};
    return made;
}

double cost_of(const std::vector<VeinCourse>& courses, const HeadAxis& axis)
{
    double cost = 0.0, length = 0.0;
    for (const VeinCourse& course : courses) {
        const AxialCourse made = axial(course, axis);
        for (size_t i = 0; i < course.size(); ++i) {
            const double d = glm::dot(glm::dvec2(made.points[i]), made.normal) / AXIS_PLAY;
            cost += course[i].length * std::log1p(d * d);
            length += course[i].length;
        }
    }
    return cost / length;
}

/// The principal axis around which the sections' moments are most equal, and the strength of this symmetry: 1 for a
/// disc, 0 for a ball, small for half a disc.
struct Symmetry {
    glm::dvec3 direction{0.0, 0.0, 1.0};
    double strength = 0.0;
};

Symmetry symmetry_of(const Eigen& principal)
{
    Symmetry found;
    double least = 2.0;
    for (size_t i = 0; i < 3; ++i) {
        const double a = principal.values[(i + 1) % 3], b = principal.values[(i + 2) % 3], own = principal.values[i];
        const double uneven = a + b > 0.0 ? std::abs(a - b) / (a + b) : 1.0;
        if (uneven >= least) continue;
        least = uneven;
        const double differs = std::abs(own - 0.5 * (a + b)) / std::max(own, 0.5 * (a + b));
        found = {principal.vectors[i], (1.0 - uneven) * (1.0 - uneven) * differs * differs};
    }
    return found;
}

/// Normal equations of a Gauss-Newton step; the unknowns are changes of the axis's direction (2) and position (2).
struct AxisEquations {
    glm::dmat4 normal{0.0};
    glm::dvec4 right{0.0};
    double length = 0.0, squares = 0.0;

    /// Adds the equations of a vein, after eliminating the unknown rotation of the vein's plane around the axis.
    void add(const VeinCourse& course, const AxialCourse& made)
    {
        const glm::dvec2 n = made.normal, in_plane(-n.y, n.x);
        glm::dvec4 mixed(0.0);
        double turning = 0.0, turned = 0.0;
        for (size_t i = 0; i < course.size(); ++i) {
            const glm::dvec3& p = made.points[i];
            const double d = glm::dot(glm::dvec2(p), n), turn = -glm::dot(glm::dvec2(p), in_plane);
            const double weight = course[i].length / (1.0 + d * d / (AXIS_PLAY * AXIS_PLAY));
            const glm::dvec4 slope(-n.x * p.z, -n.y * p.z, -n.x, -n.y);
            normal += weight * glm::outerProduct(slope, slope);
            right -= weight * d * slope;
            mixed += weight * turn * slope;
            turning += weight * turn * turn;
            turned -= weight * turn * d;
            squares += weight * d * d;
            length += course[i].length;
        }
        if (!(turning > 0.0)) return;
        normal -= glm::outerProduct(mixed, mixed) / turning;
        right -= mixed * (turned / turning);
    }
};

/// Refines the axis by Gauss-Newton steps. Slight damping preserves components that the veins do not determine.
HeadAxis refined(const std::vector<VeinCourse>& courses, const Symmetry& symmetry, HeadAxis axis)
{
    for (int step = 0; step < 40; ++step) {
        const auto [x, y] = across(axis.direction);
        AxisEquations equations;
        for (const VeinCourse& course : courses) equations.add(course, axial(course, axis));
        const double sign = glm::dot(symmetry.direction, axis.direction) < 0.0 ? -1.0 : 1.0;
        const glm::dvec3 towards = sign * symmetry.direction - axis.direction;
        const double pull = SYMMETRY_WEIGHT * symmetry.strength * equations.squares;
        equations.normal[0][0] += pull;
        equations.normal[1][1] += pull;
        equations.right += pull * glm::dvec4(glm::dot(towards, x), glm::dot(towards, y), 0.0, 0.0);
        const glm::dvec4 by = glm::inverse(equations.normal + glm::dmat4(1e-9 * equations.length)) * equations.right;
        const double size = glm::length(by);
        if (!(size < 1e6)) break;
        const double share = std::min(1.0, 0.5 / size);
        axis.centre += share * (by.z * x + by.w * y);
        axis.direction = glm::normalize(axis.direction + share * (by.x * x + by.y * y));
        if (size < 1e-14) break;
    }
    axis.centre -= axis.direction * glm::dot(axis.centre, axis.direction);
    return axis;
}

/// Length of the mean of exp(2 i azimuth): 1 if all veins lie in one plane through the axis, near 0 if all around it.
double one_sidedness(const std::vector<VeinCourse>& courses, const HeadAxis& axis)
{
    const auto [x, y] = across(axis.direction);
    glm::dvec2 sum(0.0);
    double all = 0.0;
    for (const VeinCourse& course : courses)
        for (const VeinPoint& point : course) {
            const glm::dvec2 p(glm::dot(point.at - axis.centre, x), glm::dot(point.at - axis.centre, y));
            const double square = glm::dot(p, p);
            if (!(square > 0.0)) continue;
            sum += point.length * glm::dvec2(p.x * p.x - p.y * p.y, 2.0 * p.x * p.y) / square;
            all += point.length;
        }
    return all > 0.0 ? glm::length(sum) / all : 1.0;
}

/// Like `one_sidedness`, but of the sections, weighted by the square of the distance from the axis.
double flatness_around(const Moments& moments, const HeadAxis& axis)
{
    const auto [x, y] = across(axis.direction);
    const glm::dvec3 off = moments.mean() - axis.centre;
    const glm::dmat3 squares = moments.covariance() + glm::outerProduct(off, off);
    const double xx = glm::dot(x, squares * x), yy = glm::dot(y, squares * y), xy = glm::dot(x, squares * y);
    return xx + yy > 0.0 ? std::hypot(xx - yy, 2.0 * xy) / (xx + yy) : 1.0;
}

/// Starting values: the principal axes, and the lines that best meet all pieces by linear least squares. A line of
/// direction w and moment v = c x w meets the line of direction t through p if t . v + (p x t) . w = 0.
std::vector<HeadAxis> starts_of(const std::vector<VeinCourse>& courses, const Moments& moments, const Eigen& principal)
{
    std::vector<HeadAxis> starts;
    for (const glm::dvec3& direction : principal.vectors) starts.push_back({direction, moments.mean()});
    glm::dmat3 ww(0.0), wv(0.0), vv(0.0);
    double length = 0.0;
    for (const VeinCourse& course : courses)
        for (size_t i = 0; i + 1 < course.size(); ++i) {
            const glm::dvec3 way = course[i + 1].at - course[i].at;
            const double weight = glm::length(way);
            if (!(weight > 0.0)) continue;
            const glm::dvec3 direction = way / weight, moment = glm::cross(course[i].at, direction);
            ww += weight * glm::outerProduct(moment, moment);
            wv += weight * glm::outerProduct(moment, direction);  // columns go with v
            vv += weight * glm::outerProduct(direction, direction);
            length += weight;
        }
    const glm::dmat3 moment_of = -glm::inverse(vv + glm::dmat3(1e-9 * length)) * glm::transpose(wv);
    const Eigen lines = eigen_of(ww + wv * moment_of);
    for (const glm::dvec3& direction : lines.vectors)
        starts.push_back({direction, glm::cross(direction, moment_of * direction)});
    return starts;
}

}  // namespace

std::vector<VeinCourse> abaxial_courses(const VeinGraph& graph, const std::vector<glm::dvec3>& scaled)
{
    const auto is_vein = [&](uint32_t link) {
        return graph.links()[link].is_vein_of(HeadPart::abaxial) && graph.links()[link].length > 0.0;
    };
    const auto veins_at = [&](uint32_t node) { return std::ranges::count_if(graph.links_of(node), is_vein); };
    std::vector<bool> done(graph.links().size());
    std::vector<VeinCourse> courses;
    const auto follow = [&](uint32_t node, uint32_t link) {
        VeinCourse course{{scaled[node], 0.0}};
        for (bool goes_on = true; goes_on;) {
            done[link] = true;
            node = graph.links()[link].other(node);
            const double half = 0.5 * glm::length(scaled[node] - course.back().at);
            course.back().length += half;
            course.push_back({scaled[node], half});
            goes_on = false;
            if (veins_at(node) == 2)
                for (const uint32_t next : graph.links_of(node))
                    if (is_vein(next) && !done[next]) {
                        link = next;
                        goes_on = true;
                        break;
                    }
        }
        courses.push_back(std::move(course));
    };
    // First the veins that begin at ends and branches; all internodes that are left then belong to rings.
    for (const bool from_ends : {true, false})
        for (uint32_t link = 0; link < graph.links().size(); ++link)
            for (const uint32_t node : {graph.links()[link].a, graph.links()[link].b})
                if (is_vein(link) && !done[link] && (!from_ends || veins_at(node) != 2)) follow(node, link);
    return courses;
}

std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& direction)
{
    const glm::dvec3 size = glm::abs(direction);
    const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1.0, 0.0, 0.0)
                             : size.y <= size.z                   ? glm::dvec3(0.0, 1.0, 0.0)
                                                                  : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 x = glm::normalize(other - direction * glm::dot(other, direction));
    return {x, glm::cross(direction, x)};
}

std::optional<HeadAxis> axis_of_veins(const std::vector<VeinCourse>& courses, const Moments& moments)
{
    size_t pieces = 0;
    for (const VeinCourse& course : courses) pieces += course.size() - 1;
    if (pieces < 3) return {};
    const Eigen principal = eigen_of(moments.covariance());
    const Symmetry symmetry = symmetry_of(principal);
    std::optional<HeadAxis> best;
    double least = 0.0;
    for (const HeadAxis& start : starts_of(courses, moments, principal)) {
        const HeadAxis axis = refined(courses, symmetry, start);
        const double one_sided = one_sidedness(courses, axis);
        if (!(one_sided < 0.9)) continue;
        const double cost = cost_of(courses, axis) + 2.0 * one_sided + 2.0 * flatness_around(moments, axis);
        if (best && !(cost < least - 1e-9)) continue;
        best = axis;
        least = cost;
    }
    return best;
}

}  // namespace shvr
