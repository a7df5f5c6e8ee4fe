#include "engine/annotation/measures/trace_course.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace shvr {

std::vector<TraceSample> samples_of(const TraceGraph& trace, const TraceInternode& internode, double step)
{
    const glm::dvec3 a = trace.node(internode.a).position, b = trace.node(internode.b).position;
    const double length = glm::length(b - a);
    const int parts = length > 64.0 * step ? 64 : std::max(1, int(std::ceil(length / step)));
    std::vector<TraceSample> samples;
    for (int i = 0; i <= parts; ++i) {
        const double t = double(i) / parts;
        samples.push_back({(1.0 - t) * a + t * b, trace.radius_of(internode, t)});
    }
    return samples;
}

TraceCourse::TraceCourse(const TraceGraph& trace) : segments_(segments_of(trace))
{
    double whole_length = 0.0;
    for (const auto& [number, internode] : trace.internodes()) whole_length += trace.length_of(internode);
    // Splits the few internodes that are much longer than average: the search radius is half the longest piece, so one
    // long internode would slow down every query.
    const double longest = 2.0 * whole_length / double(std::max<size_t>(1, trace.internodes().size()));
    for (size_t s = 0; s < segments_.size(); ++s) {
        const TraceSegment& segment = segments_[s];
        double along = 0.0;
        for (size_t i = 0; i < segment.internodes.size(); ++i) {
            const TraceInternode& internode = trace.internode(segment.internodes[i]);
            const bool is_forwards = internode.a == segment.nodes[i];
            const double length = trace.length_of(internode);
            const int parts = length > longest ? int(std::ceil(length / longest)) : 1;
            const glm::dvec3 a = trace.node(segment.nodes[i]).position, b = trace.node(segment.nodes[i + 1]).position;
            for (int part = 0; part < parts; ++part) {
                const double from = double(part) / parts, to = double(part + 1) / parts;
                pieces_.push_back({(1.0 - from) * a + from * b, (1.0 - to) * a + to * b,
                                   trace.radius_of(internode, is_forwards ? from : 1.0 - from),
                                   trace.radius_of(internode, is_forwards ? to : 1.0 - to), s, along + from * length});
                const Piece& piece = pieces_.back();
                middles_.set(uint32_t(pieces_.size() - 1), (piece.a + piece.b) / 2.0);
                longest_half_ = std::max(longest_half_, length / parts / 2.0);
                largest_radius_ = std::max({largest_radius_, piece.radius_a, piece.radius_b});
            }
            along += length;
        }
        lengths_.push_back(along);
    }
    // Margin for rounding of positions.
    longest_half_ *= 1.0 + 1e-9;
    for (const Piece& piece : pieces_)
        for (int axis = 0; axis < 3; ++axis)
            rounding_ = std::max({rounding_, 1e-13 * std::abs(piece.a[axis]), 1e-13 * std::abs(piece.b[axis])});
}

TraceCourse::Foot TraceCourse::foot_on(const Piece& piece, const glm::dvec3& position)
{
    const glm::dvec3 way = piece.b - piece.a;
    const double squared = glm::dot(way, way);
    const double t = squared > 0.0 ? glm::clamp(glm::dot(position - piece.a, way) / squared, 0.0, 1.0) : 0.0;
    return {glm::length(position - (piece.a + t * way)), t};
}

std::vector<TraceCourse::Near> TraceCourse::near(const TraceSample& sample, double slack) const
{
    std::map<size_t, Near> nearest;
    const double reach = sample.radius + largest_radius_ + slack + rounding_;
    for (const uint32_t number : middles_.within(sample.position, reach + longest_half_)) {
        const Piece& piece = pieces_[number];
        const Foot foot = foot_on(piece, sample.position);
        const double radius = (1.0 - foot.t) * piece.radius_a + foot.t * piece.radius_b;
        if (foot.distance > sample.radius + radius + slack + rounding_) continue;
        const double along = piece.along + foot.t * glm::length(piece.b - piece.a);
        const auto [found, is_new] = nearest.try_emplace(piece.segment, Near{piece.segment, foot.distance, along});
        if (!is_new && foot.distance < found->second.distance) found->second = {piece.segment, foot.distance, along};
    }
    std::vector<Near> all;
    for (const auto& [segment, near] : nearest) all.push_back(near);
    return all;
}

std::optional<TraceCourse::Nearest> TraceCourse::nearest_to(const glm::dvec3& position) const
{
    const std::optional<uint32_t> first = middles_.nearest(position);
    if (!first) return std::nullopt;
    Nearest nearest{*first, distance_to_piece(*first, position)};
    for (const uint32_t number : middles_.within(position, nearest.distance + longest_half_))
        if (const double distance = distance_to_piece(number, position); distance < nearest.distance)
            nearest = {number, distance};
    return nearest;
}

double TraceCourse::distance_to_piece(size_t piece, const glm::dvec3& position) const
{
    return foot_on(pieces_[piece], position).distance;
}

}  // namespace shvr
