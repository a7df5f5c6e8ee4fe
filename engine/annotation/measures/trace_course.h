#pragma once
// Where along a trace a place is: the segments of the trace in short pieces, searched by an index. Exact: a k-d tree of
// the pieces' middles gives candidates within half of the longest piece's length, and distances are to the pieces.
// Any thread may ask.

#include <vector>

#include "engine/annotation/trace/trace_index.h"
#include "engine/annotation/trace/trace_segments.h"

namespace shvr {

/// A place of a trace, and its radius there.
struct TraceSample {
    glm::dvec3 position;
    double radius;
};
/// Along an internode from end to end, both ends among them, at most `step` apart but no more than 65.
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
        double along;  ///< from where the segment begins
    };
    /// The segments that a ball touches once both have grown by `slack` together, each where it is nearest; ascending.
    std::vector<Near> near(const TraceSample& sample, double slack) const;
    /// To the nearest place of any; infinite where there is none.
    double distance_to(const glm::dvec3& position) const;

private:
    struct Piece {
        glm::dvec3 a, b;
        double radius_a, radius_b;
        size_t segment;
        double along;  ///< at a
    };
    struct Foot {
        double distance, t;
    };
    static Foot foot_on(const Piece& piece, const glm::dvec3& position);

    std::vector<TraceSegment> segments_;
    std::vector<double> lengths_;
    std::vector<Piece> pieces_;
    TraceIndex middles_;  ///< numbers are places in `pieces_`
    double longest_half_ = 0.0, largest_radius_ = 0.0;
};

}  // namespace shvr
