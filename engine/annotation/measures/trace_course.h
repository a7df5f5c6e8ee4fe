#pragma once
// Locates positions along a trace. Segments are cut into short pieces, and a k-d tree of the pieces' midpoints gives
// all candidates (within half of the longest piece's length). Distances are measured to the pieces themselves, so
// results are exact. Any thread may query.

#include <optional>
#include <vector>

#include "engine/annotation/trace/trace_index.h"
#include "engine/annotation/trace/trace_segments.h"

namespace shvr {

/// A position on a trace, with the trace's radius there.
struct TraceSample {
    glm::dvec3 position;
    double radius;
};
/// Returns samples along an internode, including both ends: at most `step` apart, unless that needs more than 65.
std::vector<TraceSample> samples_of(const TraceGraph& trace, const TraceInternode& internode, double step);

class TraceCourse {
public:
    /// Keeps a reference to the trace.
    explicit TraceCourse(const TraceGraph& trace);

    const std::vector<TraceSegment>& segments() const { return segments_; }
    double length_of(size_t segment) const { return lengths_[segment]; }

    struct Near {
        size_t segment;
        double distance;
        double along;  ///< distance from the start of the segment
    };
    /// Returns, in ascending order, the segments that touch a ball or miss it by at most `slack` (up to rounding
    /// errors), each with its position nearest to the ball.
    std::vector<Near> near(const TraceSample& sample, double slack) const;
    struct Nearest {
        size_t piece;  ///< a straight part of a segment
        double distance;
    };
    /// The nearest position on any segment; null if there are no segments.
    std::optional<Nearest> nearest_to(const glm::dvec3& position) const;
    double distance_to_piece(size_t piece, const glm::dvec3& position) const;
    /// Upper bound of the rounding error of a distance.
    double rounding() const { return rounding_; }

private:
    struct Piece {
        glm::dvec3 a, b;
        double radius_a, radius_b;
        size_t segment;
        double along;  ///< position of `a` along the segment
    };
    struct Foot {
        double distance, t;
    };
    static Foot foot_on(const Piece& piece, const glm::dvec3& position);

    std::vector<TraceSegment> segments_;
    std::vector<double> lengths_;
    std::vector<Piece> pieces_;
    TraceIndex middles_;  ///< the numbers are indices into `pieces_`
    double longest_half_ = 0.0, largest_radius_ = 0.0;
    double rounding_ = 0.0;
};

}  // namespace shvr
