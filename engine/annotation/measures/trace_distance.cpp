#include "engine/annotation/measures/trace_distance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace shvr {

namespace {

constexpr double MAX_PRECISION = 1e-9;

/// A part of an internode of the trace.
struct Part {
    struct End {
        glm::dvec3 position;
        TraceCourse::Nearest nearest;
    };
    End a, b;
};

/// Returns an upper bound of the distance of a part from the truth. Along the straight part, the distance to one piece
/// of the truth is convex, so it is greatest at an end. Moving by d changes a distance by at most d.
double upper_bound(const Part& part, const TraceCourse& truth)
{
    const double at_a = part.a.nearest.distance, at_b = part.b.nearest.distance;
    return std::min({std::max(at_a, truth.distance_to_piece(part.a.nearest.piece, part.b.position)),
                     std::max(at_b, truth.distance_to_piece(part.b.nearest.piece, part.a.position)),
                     0.5 * (at_a + at_b + glm::length(part.b.position - part.a.position))});
}

/// Branch and bound: bisects a part while the part's upper bound exceeds `greatest`, the greatest distance so far.
void search(const Part& whole, const TraceCourse& truth, double& greatest)
{
    std::vector<Part> parts{whole};
    while (!parts.empty()) {
        const Part part = parts.back();
        parts.pop_back();
        if (upper_bound(part, truth) <= greatest * (1.0 + MAX_PRECISION) + truth.rounding()) continue;
        const glm::dvec3 middle = 0.5 * part.a.position + 0.5 * part.b.position;
        if (middle == part.a.position || middle == part.b.position) continue;  // limit of floating-point resolution
        const Part::End between{middle, truth.nearest_to(middle).value()};
        greatest = std::max(greatest, between.nearest.distance);
        parts.push_back({part.a, between});
        parts.push_back({between, part.b});
    }
}

double greatest_distance(const TraceGraph& trace, const TraceCourse& truth)
{
    std::map<uint32_t, Part::End> ends;
    double greatest = 0.0;
    for (const auto& [number, internode] : trace.internodes())
        for (const uint32_t node : {internode.a, internode.b}) {
            if (ends.contains(node)) continue;
            const glm::dvec3 position = trace.node(node).position;
            const TraceCourse::Nearest nearest = truth.nearest_to(position).value();
            ends.emplace(node, Part::End{position, nearest});
            greatest = std::max(greatest, nearest.distance);
        }
    for (const auto& [number, internode] : trace.internodes())
        search({ends.at(internode.a), ends.at(internode.b)}, truth, greatest);
    return greatest;
}

}  // namespace

std::optional<TraceDistance> distance_from(const TraceGraph& trace, const TraceCourse& truth)
{
    if (truth.segments().empty()) return std::nullopt;
    // Two-point Gauss-Legendre quadrature in each part. It is exact for polynomials up to degree 3, and the squared
    // distance to a line is a polynomial of degree 2.
    constexpr int PARTS = 8;
    constexpr double AWAY = 0.5 * std::numbers::inv_sqrt3;
    double sum = 0.0, length_sum = 0.0;
    for (const auto& [number, internode] : trace.internodes()) {
        const glm::dvec3 a = trace.node(internode.a).position, b = trace.node(internode.b).position;
        const double length = glm::length(b - a) / (2 * PARTS);
        for (int part = 0; part < PARTS; ++part)
            for (const double place : {0.5 - AWAY, 0.5 + AWAY}) {
                const double t = (part + place) / PARTS;
                const double distance = truth.nearest_to((1.0 - t) * a + t * b)->distance;
                sum += length * distance * distance;
                length_sum += length;
            }
    }
    if (length_sum == 0.0) return std::nullopt;
    return TraceDistance{std::sqrt(sum / length_sum), greatest_distance(trace, truth)};
}

}  // namespace shvr
