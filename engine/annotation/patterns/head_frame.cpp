#include "engine/annotation/patterns/head_frame.h"

#include <algorithm>
#include <numbers>

#include "engine/annotation/patterns/axes.h"

namespace shvr {

namespace {

struct Axis {
    glm::dvec3 direction, centre;
};

/// A straight piece of a vein in scaled coordinates.
struct Piece {
    glm::dvec3 middle, direction;
    double length;
};

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
    // Nodes at one place differ only by rounding.
    scale.size = squares > 1e-24 * largest * largest ? std::sqrt(squares) : 0.0;
    return scale;
}

std::vector<Piece> abaxial_pieces(const VeinGraph& graph, const Scale& scale)
{
    std::vector<Piece> pieces;
    for (const VeinLink& link : graph.links()) {
        if (!link.is_vein_of(HeadPart::abaxial) || !(link.length > 0.0)) continue;
        const glm::dvec3 a = scale.scaled(graph.nodes()[link.a].at), b = scale.scaled(graph.nodes()[link.b].at);
        pieces.push_back({0.5 * (a + b), (b - a) * (scale.size / link.length), link.length / scale.size});
    }
    return pieces;
}

/// Returns a unit vector across `direction`, and the third axis.
std::pair<glm::dvec3, glm::dvec3> across(const glm::dvec3& direction)
{
    const glm::dvec3 size = glm::abs(direction);
    const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1.0, 0.0, 0.0)
                             : size.y <= size.z                   ? glm::dvec3(0.0, 1.0, 0.0)
                                                                  : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 x = glm::normalize(other - direction * glm::dot(other, direction));
    return {x, glm::cross(direction, x)};
}

constexpr double AXIS_PLAY = 0.05;  ///< in root mean square radii; veins that miss the axis by more count little

double cost_of(const std::vector<Piece>& pieces, const Axis& axis)
{
    double cost = 0.0, length = 0.0;
    for (const Piece& piece : pieces) {
        const double e = glm::dot(piece.middle - axis.centre, glm::cross(piece.direction, axis.direction)) / AXIS_PLAY;
        cost += piece.length * std::log1p(e * e);
        length += piece.length;
    }
    return cost / length;
}

/// Gauss and Newton's steps for direction (2) and place (2). Slight damping keeps what the pieces do not decide.
Axis refined(const std::vector<Piece>& pieces, Axis axis)
{
    for (int step = 0; step < 30; ++step) {
        const auto [x, y] = across(axis.direction);
        glm::dmat4 normal(0.0);
        glm::dvec4 right(0.0);
        double length = 0.0;
        for (const Piece& piece : pieces) {
            const glm::dvec3 p = piece.middle - axis.centre, out = glm::cross(piece.direction, axis.direction);
            const double e = glm::dot(p, out);
            const double weight = piece.length / (1.0 + e * e / (AXIS_PLAY * AXIS_PLAY));
            const glm::dvec4 slope(glm::dot(p, glm::cross(piece.direction, x)),
                                   glm::dot(p, glm::cross(piece.direction, y)), -glm::dot(out, x), -glm::dot(out, y));
            normal += weight * glm::outerProduct(slope, slope);
            right -= weight * e * slope;
            length += piece.length;
        }
        const glm::dvec4 by = glm::inverse(normal + glm::dmat4(1e-9 * length)) * right;
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

/// Length of the mean of exp(2 i azimuth): 1 if all pieces lie in one plane through the axis, near 0 if around it.
double one_sidedness(const std::vector<Piece>& pieces, const Axis& axis)
{
    const auto [x, y] = across(axis.direction);
    glm::dvec2 sum(0.0);
    double all = 0.0;
    for (const Piece& piece : pieces) {
        const glm::dvec2 p(glm::dot(piece.middle - axis.centre, x), glm::dot(piece.middle - axis.centre, y));
        const double square = glm::dot(p, p);
        if (!(square > 0.0)) continue;
        sum += piece.length * glm::dvec2(p.x * p.x - p.y * p.y, 2.0 * p.x * p.y) / square;
        all += piece.length;
    }
    return all > 0.0 ? glm::length(sum) / all : 1.0;
}

/// Starts: the principal axes, and the lines that best meet all pieces by linear least squares (lines as pairs of
/// direction w and moment v = c x w meet if t . v + (p x t) . w = 0).
std::vector<Axis> starts_of(const std::vector<Piece>& pieces, const Eigen& principal)
{
    std::vector<Axis> starts;
    for (const glm::dvec3& direction : principal.vectors) starts.push_back({direction, glm::dvec3(0.0)});
    glm::dmat3 ww(0.0), wv(0.0), vv(0.0);
    double length = 0.0;
    for (const Piece& piece : pieces) {
        const glm::dvec3 moment = glm::cross(piece.middle, piece.direction);
        ww += piece.length * glm::outerProduct(moment, moment);
        wv += piece.length * glm::outerProduct(moment, piece.direction);  // columns go with v
        vv += piece.length * glm::outerProduct(piece.direction, piece.direction);
        length += piece.length;
    }
    const glm::dmat3 moment_of = -glm::inverse(vv + glm::dmat3(1e-9 * length)) * glm::transpose(wv);
    const Eigen lines = eigen_of(ww + wv * moment_of);
    for (const glm::dvec3& direction : lines.vectors)
        starts.push_back({direction, glm::cross(direction, moment_of * direction)});
    return starts;
}

std::optional<Axis> axis_of_abaxial(const std::vector<Piece>& pieces, const Eigen& principal)
{
    if (pieces.size() < 3) return {};
    std::optional<Axis> best;
    double least = 0.0;
    for (const Axis& start : starts_of(pieces, principal)) {
        const Axis axis = refined(pieces, start);
        const double one_sided = one_sidedness(pieces, axis);
        if (!(one_sided < 0.9)) continue;
        // In a flat head any line across the axis meets all veins but those of the stem, most of them from two sides.
        const double cost = cost_of(pieces, axis) + 2.0 * one_sided;
        if (best && !(cost < least - 1e-9)) continue;
        best = axis;
        least = cost;
    }
    return best;
}

double residual_of(const std::vector<Piece>& pieces, const Axis& axis)
{
    double sum = 0.0, length = 0.0;
    for (const Piece& piece : pieces) {
        const glm::dvec3 around = glm::cross(axis.direction, piece.middle - axis.centre);
        const double size = glm::length(around);
        if (!(size > 1e-9)) continue;
        const double angle = std::asin(std::min(1.0, std::abs(glm::dot(around, piece.direction)) / size));
        sum += piece.length * angle * angle;
        length += piece.length;
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

}  // namespace

FoundFrame fit_frame(const VeinGraph& graph)
{
    const Scale scale = scale_of(graph);
    if (!(scale.size > 0.0)) return {.reason = "the nodes of the sections are at one place"};
    const Moments all = moments_of(graph, scale, {});
    const Eigen shape = eigen_of(all.covariance());
    if (!(shape.values[1] > 1e-12 * shape.values[2])) return {.reason = "the sections lie on one straight line"};

    HeadFrame frame;
    std::optional<Axis> axis;
    const std::vector<Piece> pieces = abaxial_pieces(graph, scale);
    axis = axis_of_abaxial(pieces, shape);
    if (axis) {
        frame.residual_degrees = residual_of(pieces, *axis);
        if (*frame.residual_degrees > 30.0)
            return {.reason = "the abaxial veins do not run in planes through one axis"};
    } else {
        const bool by_florets = graph.count(HeadPart::floret) >= 12;
        const Moments moments = by_florets ? moments_of(graph, scale, HeadPart::floret) : all;
        const Eigen principal = eigen_of(moments.covariance());
        const double below = principal.values[1] - principal.values[0];
        const double above = principal.values[2] - principal.values[1];
        if (!(std::max(below, above) > 0.1 * principal.values[2]))
            return {.reason = "no axis differs from the others, and there are no abaxial veins around one"};
        axis = Axis{principal.vectors[below >= above ? 0 : 2], moments.mean()};
    }
    frame.up = axis->direction;
    std::tie(frame.x, frame.y) = across(frame.up);
    // The point of the axis that is nearest to the sections' middle.
    const glm::dvec3 foot = axis->centre - frame.up * glm::dot(axis->centre, frame.up);
    frame.centre = scale.mean + scale.size * foot;
    orient(graph, frame);
    return {.frame = frame};
}

}  // namespace shvr
