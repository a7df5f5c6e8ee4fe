#pragma once
// Matches parts of a trace with parts of the truth: nodes with branches and ends, segments with segments. A trace is a
// multigraph: several segments may join the same two nodes, and are then told apart by their courses. Any thread may
// query.

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "engine/annotation/measures/trace_course.h"

namespace shvr {

class TraceMatch {
public:
    /// Keeps references to the three objects; `course` is the course of the truth.
    TraceMatch(const TraceGraph& trace, const TraceGraph& truth, const TraceCourse& course, double slack);

    /// For each paired branch or end of the truth, the node of the trace that it is paired with; one to one.
    const std::map<uint32_t, uint32_t>& paired() const { return paired_; }
    /// Those nodes of the trace.
    const std::set<uint32_t>& stops() const { return stops_; }

    /// The segments of the trace, which also end at the nodes in `stops()`.
    const std::vector<TraceSegment>& segments() const { return segments_; }
    /// The segment of the truth that a segment of the trace stands for, if any; one to one. The ends of the two are
    /// paired, and each segment is near the other along its whole length. If several segments join the same two nodes,
    /// those with the smallest mean squared distance are matched first.
    std::optional<size_t> partner_of(size_t segment) const { return partners_[segment]; }

    /// Whether a segment of the truth is found (trace_score.h).
    bool is_found(size_t truth_segment) const;

    /// Samples along a segment of the trace, in order; their spacing is about half of the distance that counts as near.
    std::vector<TraceSample> samples_along(const TraceSegment& segment) const;

private:
    void pair_nodes();
    void find_near();
    void pair_segments();
    bool has_ends_of(const TraceSegment& segment, const TraceSegment& truth) const;
    std::vector<size_t> near_all(const TraceSegment& segment) const;
    std::optional<double> distance_between(const TraceSegment& segment, size_t truth_segment) const;
    std::vector<uint32_t> free_near(size_t truth_segment) const;
    std::vector<uint32_t> ways_between(const std::vector<uint32_t>& internodes, uint32_t from, uint32_t to) const;
    std::vector<uint32_t> core_of(const std::vector<uint32_t>& internodes, const std::set<uint32_t>& kept = {}) const;
    std::optional<double> covers(size_t truth_segment, const std::vector<uint32_t>& internodes) const;

    const TraceGraph &trace_, &truth_;
    const TraceCourse& course_;
    double slack_;
    std::map<uint32_t, uint32_t> paired_;
    std::set<uint32_t> stops_;
    std::map<uint32_t, std::vector<size_t>> near_;  ///< internode of the trace -> near segments of the truth, ascending
    std::vector<TraceSegment> segments_;
    std::vector<std::optional<size_t>> partners_;        ///< per segment of the trace
    std::vector<std::optional<size_t>> truth_partners_;  ///< per segment of the truth
    std::map<uint32_t, size_t> segment_of_;              ///< internode of the trace -> its segment
};

}  // namespace shvr
