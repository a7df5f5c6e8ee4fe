#include "engine/annotation/patterns/head_frame.h"

#include <algorithm>
#include <numbers>

#include "engine/annotation/patterns/head_axis.h"

namespace shvr {

namespace {

/// Largest difference of the two moments across a principal axis, relative to their sum.
constexpr double MAX_UNEVEN = 0.2;
constexpr double UNKNOWN = 100.0;  ///< an error of place larger than any head

/// Scaled coordinates: the mean of the sections' nodes is 0, and their root mean square distance from it is 1.
struct Scale {
    glm::dvec3 mean{0.0};
    double size = 0.0;
    glm::dvec3 scaled(const glm::dvec3& at) const { return (at - mean) / size; }
};

Scale scale_of(const VeinGraph& graph)
{
    Scale scale;
    double count = 0.0, squares = 0.0, largest = 0.0;
    for (const VeinNode& node : graph.nodes()) {
        if (node.part == HeadPart::none) continue;
        count += 1.0;
        scale.mean += (node.at - scale.mean) / count;
    }
    for (const VeinNode& node : graph.nodes()) {
        if (node.part == HeadPart::none) continue;
        const glm::dvec3 d = node.at - scale.mean;
        squares += glm::dot(d, d) / count;
        largest = std::max({largest, std::abs(node.at.x), std::abs(node.at.y), std::abs(node.at.z)});
    }
    // Smaller squares come from rounding alone: all nodes are at one place.
    scale.size = squares > 1e-24 * largest * largest ? std::sqrt(squares) : 0.0;
    return scale;
}

/// Measured on chords of 0.3 radii of the sections (or whole veins): the directions of short pieces are mostly noise.
double residual_of(const std::vector<VeinCourse>& courses, const HeadAxis& axis)
{
    double sum = 0.0, length = 0.0;
    for (const VeinCourse& course : courses)
        for (size_t i = 0, j = 1; j < course.size(); ++i) {
            while (j + 1 < course.size() && (j <= i || glm::distance(course[j].at, course[i].at) < 0.3)) ++j;
            const glm::dvec3 chord = course[j].at - course[i].at;
            const glm::dvec3 around = glm::cross(axis.direction, 0.5 * (course[i].at + course[j].at) - axis.centre);
            const double size = glm::length(around) * glm::length(chord);
            if (size > 1e-9) {
                const double angle = std::asin(std::min(1.0, std::abs(glm::dot(around, chord)) / size));
                sum += glm::length(chord) * angle * angle;
                length += glm::length(chord);
            }
            if (j + 1 == course.size()) break;
        }
    return length > 0.0 ? std::sqrt(sum / length) * 180.0 / std::numbers::pi : 0.0;
}

Moments moments_of(const VeinGraph& graph, const Scale& scale, std::optional<HeadPart> only)
{
    Moments moments;
    const auto counts = [&](HeadPart part) { return only ? part == *only : part != HeadPart::none; };
    if (!only)
        for (const VeinLink& link : graph.links())
            if (counts(link.part))
                moments.add(scale.scaled(graph.nodes()[link.a].at), scale.scaled(graph.nodes()[link.b].at),
                            link.length / scale.size);
    if (only || !(moments.weight() > 0.0))
        for (const VeinNode& node : graph.nodes())
            if (counts(node.part)) moments.add(scale.scaled(node.at), scale.scaled(node.at), 1.0);
    return moments;
}

/// Points the axis from the stem to the florets.
void orient(const VeinGraph& graph, HeadFrame& frame)
{
    double height[4] = {}, count[4] = {}, mean_rho = 0.0, widens = 0.0;
    for (const VeinNode& node : graph.nodes()) {
        const glm::dvec3 p = frame.local(node.at);
        height[size_t(node.part)] += p.z;
        count[size_t(node.part)] += 1.0;
        if (node.part == HeadPart::abaxial) mean_rho += std::hypot(p.x, p.y);
    }
    const auto mean = [&](HeadPart part) { return height[size_t(part)] / count[size_t(part)]; };
    const auto any = [&](HeadPart part) { return count[size_t(part)] > 0.0; };
    double up = 0.0;
    if (any(HeadPart::floret) && any(HeadPart::abaxial))
        up = mean(HeadPart::floret) - mean(HeadPart::abaxial);
    else if (any(HeadPart::floret) && any(HeadPart::adaxial))
        up = mean(HeadPart::floret) - mean(HeadPart::adaxial);
    else if (any(HeadPart::adaxial) && any(HeadPart::abaxial))
        up = mean(HeadPart::adaxial) - mean(HeadPart::abaxial);
    else if (any(HeadPart::abaxial)) {  // a stem widens into a bowl
        mean_rho /= count[size_t(HeadPart::abaxial)];
        for (const VeinNode& node : graph.nodes()) {
            if (node.part != HeadPart::abaxial) continue;
            const glm::dvec3 p = frame.local(node.at);
            widens += (std::hypot(p.x, p.y) - mean_rho) * (p.z - mean(HeadPart::abaxial));
        }
        up = widens;
    }
    double size = 0.0;
    for (const VeinNode& node : graph.nodes()) size = std::max(size, glm::length(frame.local(node.at)));
    frame.knows_up = std::abs(up) > 1e-9 * size * (widens != 0.0 ? size : 1.0);
    const bool is_down = frame.knows_up ? up < 0.0 : frame.up.z < 0.0;
    if (!is_down) return;
    frame.up = -frame.up;
    frame.y = -frame.y;
}

/// The axis of a head without abaxial veins, in scaled coordinates.
struct Principal {
    std::optional<HeadAxis> axis{};
    bool is_whole = true;  ///< about as wide to all sides; the middle of a part of a head is not on the axis
    std::string reason{};
};
Principal principal_axis(const VeinGraph& graph, const Scale& scale, const Moments& all)
{
    const bool by_florets = graph.count(HeadPart::floret) >= 12;
    const Moments moments = by_florets ? moments_of(graph, scale, HeadPart::floret) : all;
    const Eigen principal = eigen_of(moments.covariance());
    const auto& values = principal.values;
    const double below = values[1] - values[0], above = values[2] - values[1];
    if (!(std::max(below, above) > 0.1 * values[2]))
        return {.reason = "no axis differs from the others, and there are no abaxial veins around one"};
    const bool is_flat = below >= above;
    const double wide = values[is_flat ? 2 : 1], narrow = values[is_flat ? 1 : 0];
    return {.axis = HeadAxis{principal.vectors[is_flat ? 0 : 2], moments.mean()},
            .is_whole = wide - narrow <= MAX_UNEVEN * (wide + narrow)};
}

}  // namespace

FoundFrame fit_frame(const VeinGraph& graph, const std::optional<StatedAxis>& stated)
{
    const Scale scale = scale_of(graph);
    if (!(scale.size > 0.0)) return {.reason = "the nodes of the sections are at one place"};
    const Moments all = moments_of(graph, scale, {});
    const Eigen shape = eigen_of(all.covariance());
    if (!(shape.values[1] > 1e-12 * shape.values[2])) return {.reason = "the sections lie on one straight line"};

    HeadFrame frame;
    std::vector<glm::dvec3> scaled;
    for (const VeinNode& node : graph.nodes()) scaled.push_back(scale.scaled(node.at));
    const std::vector<VeinCourse> courses = abaxial_courses(graph, scaled);
    HeadAxis axis{};
    if (stated) {
        axis = {stated->direction, scale.scaled(stated->through)};
        frame.is_stated = true;
        if (!courses.empty()) frame.residual_degrees = residual_of(courses, axis);
    } else if (const std::optional<FoundAxis> found = axis_of_head(graph, scaled, courses, shape)) {
        axis = found->axis;
        frame.residual_degrees = residual_of(courses, axis);
        if (*frame.residual_degrees > 30.0)
            return {.reason = "the abaxial veins do not run in planes through one axis"};
        frame.error = {.degrees = found->turn * 180.0 / std::numbers::pi,
                       .length = found->shift * scale.size,
                       .is_ambiguous = found->is_ambiguous};
    } else {
        const Principal principal = principal_axis(graph, scale, all);
        if (!principal.axis) return {.reason = principal.reason};
        axis = *principal.axis;
        if (!principal.is_whole) frame.error = {.degrees = 90.0, .length = UNKNOWN * scale.size, .is_ambiguous = false};
    }
    frame.up = axis.direction;
    std::tie(frame.x, frame.y) = across(frame.up);
    // The point of the axis that is nearest to the mean of the sections' nodes.
    const glm::dvec3 foot = axis.centre - frame.up * glm::dot(axis.centre, frame.up);
    frame.centre = scale.mean + scale.size * foot;
    if (!frame.is_stated) orient(graph, frame);
    return {.frame = frame};
}

}  // namespace shvr
