#include "engine/annotation/patterns/head_axis.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "engine/annotation/patterns/head.h"

namespace shvr {

namespace {

constexpr int PIECES = 10;           ///< pieces of the head, each left out once
constexpr size_t STARTS = 5;         ///< best fits that are refined
constexpr double RIVAL_COST = 10.0;  ///< another axis whose cost is at most this much higher may be the right one
constexpr int DIRECTIONS = 24;       ///< that fits start from, besides the principal axes
constexpr double SURE = 3.0349;  ///< standard deviations within which 99 % of a normal distribution in the plane lies

/// Unit vector of the direction in which florets lie from veins, or 0 if there are no two sections.
glm::dvec3 upwards(const VeinGraph& graph, const std::vector<glm::dvec3>& scaled)
{
    glm::dvec3 sum[4] = {};
    double count[4] = {};
    for (size_t i = 0; i < scaled.size(); ++i) {
        sum[size_t(graph.nodes()[i].part)] += scaled[i];
        count[size_t(graph.nodes()[i].part)] += 1.0;
    }
    const auto any = [&](HeadPart part) { return count[size_t(part)] > 0.0; };
    const auto mean = [&](HeadPart part) { return sum[size_t(part)] / count[size_t(part)]; };
    const HeadPart upper = any(HeadPart::floret) ? HeadPart::floret : HeadPart::adaxial;
    const HeadPart lower = any(HeadPart::abaxial) ? HeadPart::abaxial : HeadPart::adaxial;
    return any(upper) && any(lower) ? mean(upper) - mean(lower) : glm::dvec3(0.0);
}

/// The data of a fit, with the florets' upper ends along `direction`, which points up.
AxisData data_of(const VeinGraph& graph, const std::vector<glm::dvec3>& scaled, const std::vector<VeinCourse>& courses,
                 const glm::dvec3& direction)
{
    AxisData data;
    for (const VeinCourse& course : courses) {
        AxisData::Vein vein;
        for (const VeinPoint& point : course) vein.points.push_back(point.at);
        data.veins.push_back(std::move(vein));
    }
    for (uint32_t i = 0; i < scaled.size(); ++i) {
        const HeadPart part = graph.nodes()[i].part;
        if (part == HeadPart::abaxial) data.bowl.push_back({scaled[i]});
        if (part == HeadPart::adaxial) data.adaxial.push_back({scaled[i]});
        if (part != HeadPart::floret || graph.links_of(i).size() > 1) continue;
        const bool is_upper =
            graph.links_of(i).empty() || glm::dot(direction, scaled[i] - scaled[other_end(graph, i)]) > 0.0;
        if (is_upper) data.receptacle.push_back({scaled[i]});
    }
    return data;
}

/// The point that the veins, seen along a direction, run towards: the least squares of distances from their lines.
glm::dvec3 meeting_of(const std::vector<VeinCourse>& courses, const glm::dvec3& direction)
{
    const auto [x, y] = across(direction);
    glm::dmat2 normal(1e-6);
    glm::dvec2 right(0.0);
    for (const VeinCourse& course : courses) {
        glm::dvec2 mean(0.0);
        for (const VeinPoint& point : course) mean += glm::dvec2(glm::dot(point.at, x), glm::dot(point.at, y));
        mean /= double(course.size());
        double xx = 0.0, xy = 0.0, yy = 0.0;
        for (const VeinPoint& point : course) {
            const glm::dvec2 p = glm::dvec2(glm::dot(point.at, x), glm::dot(point.at, y)) - mean;
            xx += p.x * p.x;
            xy += p.x * p.y;
            yy += p.y * p.y;
        }
        const double along = 0.5 * std::atan2(2.0 * xy, xx - yy), length = std::hypot(xx - yy, 2.0 * xy);
        const glm::dvec2 across_vein(-std::sin(along), std::cos(along));
        normal += length * glm::outerProduct(across_vein, across_vein);
        right += length * glm::dot(across_vein, mean) * across_vein;
    }
    const glm::dvec2 at = glm::inverse(normal) * right;
    return glm::length(at) < 3.0 ? at.x * x + at.y * y : glm::dvec3(0.0);
}

/// Directions that lie evenly over half a sphere, and the principal axes of the sections.
std::vector<glm::dvec3> directions_of(const Eigen& principal)
{
    std::vector<glm::dvec3> directions(principal.vectors.begin(), principal.vectors.end());
    for (int i = 0; i < DIRECTIONS; ++i) {
        const double z = (i + 0.5) / DIRECTIONS, across_z = std::sqrt(1.0 - z * z);
        const double turn = 2.0 * std::numbers::pi * i * (std::numbers::phi - 1.0);
        directions.emplace_back(across_z * std::cos(turn), across_z * std::sin(turn), z);
    }
    return directions;
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

/// Angle between two axes, without regard to their sense, and distance between them at the origin.
double turn_between(const HeadAxis& a, const HeadAxis& b)
{
    return std::asin(std::min(1.0, glm::length(glm::cross(a.direction, b.direction))));
}
double shift_between(const HeadAxis& a, const HeadAxis& b)
{
    return glm::length(glm::cross(b.centre - a.centre, a.direction));
}

/// Divides veins and points into pieces of equally many points, by azimuth, from the widest gap onwards.
void divide(AxisData& data, const HeadAxis& axis)
{
    const auto [x, y] = across(axis.direction);
    double from = 0.0;
    const auto turn_of = [&, x = x, y = y](const glm::dvec3& at) {
        const glm::dvec3 p = at - axis.centre;
        const double turn = std::atan2(glm::dot(p, y), glm::dot(p, x)) / (2.0 * std::numbers::pi) - from;
        return turn - std::floor(turn);
    };
    std::vector<double> turns;
    for (const auto* points : {&data.receptacle, &data.adaxial, &data.bowl})
        for (const AxisData::Point& point : *points) turns.push_back(turn_of(point.at));
    std::ranges::sort(turns);
    double widest = 0.0, start = 0.0;
    for (size_t i = 0; i < turns.size(); ++i) {
        const double gap = i > 0 ? turns[i] - turns[i - 1] : turns[0] + 1.0 - turns.back();
        if (gap > widest) start = turns[i];
        widest = std::max(widest, gap);
    }
    from = start - 1e-9;
    for (double& turn : turns) turn -= from + std::floor(turn - from);
    std::ranges::sort(turns);
    const auto piece_of = [&](const glm::dvec3& at) {
        const auto before = std::ranges::lower_bound(turns, turn_of(at)) - turns.begin();
        return int(std::min<size_t>(size_t(before) * PIECES / turns.size(), PIECES - 1));
    };
    for (auto* points : {&data.receptacle, &data.adaxial, &data.bowl})
        for (AxisData::Point& point : *points) point.of = piece_of(point.at);
    for (AxisData::Vein& vein : data.veins) {
        const glm::dvec3 sum = std::accumulate(vein.points.begin(), vein.points.end(), glm::dvec3(0.0));
        vein.of = piece_of(sum / double(vein.points.size()));
    }
}

/// Standard deviation along the direction in which it is largest, of components i and i + 1.
double largest(const glm::dmat4& covariance, int i)
{
    const double half = 0.5 * (covariance[i][i] + covariance[i + 1][i + 1]);
    const double uneven = std::hypot(0.5 * (covariance[i][i] - covariance[i + 1][i + 1]), covariance[i][i + 1]);
    return std::sqrt(std::max(0.0, half + uneven));
}

/// Estimates the errors of the axis (`FoundAxis`).
void estimate_errors(const AxisData& data, const AxisFit& fit, FoundAxis& found)
{
    const auto [x, y] = across(fit.axis.direction);
    std::array<glm::dvec4, PIECES> changes;
    glm::dvec4 mean(0.0);
    for (int piece = 0; piece < PIECES; ++piece) {
        const HeadAxis other = refined_axis(data, fit.axis, piece, 20).axis;
        const glm::dvec3 turn = other.direction / glm::dot(other.direction, fit.axis.direction);
        // Where the other axis meets the plane through the origin across this one.
        const glm::dvec3 at = other.centre - turn * glm::dot(other.centre, fit.axis.direction) - fit.axis.centre;
        changes[size_t(piece)] = {glm::dot(turn, x), glm::dot(turn, y), glm::dot(at, x), glm::dot(at, y)};
        mean += changes[size_t(piece)] / double(PIECES);
    }
    glm::dmat4 jackknife(0.0);
    for (const glm::dvec4& change : changes)
        jackknife += (PIECES - 1.0) / PIECES * glm::outerProduct(change - mean, change - mean);
    const glm::dmat4 spread = glm::inverse(fit.information + glm::dmat4(1e-6));
    found.turn = SURE * std::max(largest(jackknife, 0), largest(spread, 0));
    found.shift = SURE * std::max(largest(jackknife, 2), largest(spread, 2));
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

std::optional<FoundAxis> axis_of_head(const VeinGraph& graph, const std::vector<glm::dvec3>& scaled,
                                      const std::vector<VeinCourse>& courses, const Eigen& principal)
{
    size_t pieces = 0;
    for (const VeinCourse& course : courses) pieces += course.size() - 1;
    if (pieces < 3) return {};
    const glm::dvec3 up = upwards(graph, scaled);
    std::vector<AxisFit> fits;
    for (glm::dvec3 direction : directions_of(principal)) {
        if (glm::dot(direction, up) < 0.0) direction = -direction;
        const AxisData data = data_of(graph, scaled, courses, direction);
        fits.push_back(refined_axis(data, {direction, meeting_of(courses, direction)}, -1, 7));
    }
    std::ranges::sort(fits, {}, &AxisFit::cost);
    fits.resize(std::min(fits.size(), STARTS));
    for (AxisFit& fit : fits) {
        if (glm::dot(fit.axis.direction, up) < 0.0) fit.axis.direction = -fit.axis.direction;
        fit = refined_axis(data_of(graph, scaled, courses, fit.axis.direction), fit.axis);
    }
    std::erase_if(fits, [&](const AxisFit& fit) { return !(one_sidedness(courses, fit.axis) < 0.9); });
    if (fits.empty()) return {};
    std::ranges::sort(fits, {}, &AxisFit::cost);
    const AxisFit& best = fits[0];
    FoundAxis found{.axis = best.axis};
    AxisData data = data_of(graph, scaled, courses, best.axis.direction);
    divide(data, best.axis);
    estimate_errors(data, best, found);
    for (const AxisFit& fit : fits)
        found.is_ambiguous |= fit.cost < best.cost + RIVAL_COST &&
                              (turn_between(fit.axis, best.axis) > 0.1 || shift_between(fit.axis, best.axis) > 0.1);
    return found;
}

}  // namespace shvr
