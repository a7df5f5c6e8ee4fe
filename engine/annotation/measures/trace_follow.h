#pragma once
// Finds the parts of the truth that each segment of a trace follows; trace_score.h defines the terms. Any thread may
// query.

#include <map>
#include <set>
#include <vector>

#include "engine/annotation/measures/trace_match.h"

namespace shvr {

/// A segment of the trace that follows a segment of the truth, and the parts of the latter that it follows.
struct Follower {
    size_t segment;  ///< index in the trace
    bool is_partner;
    std::vector<glm::dvec2> runs;  ///< intervals of length along the truth's segment, ascending and disjoint
    double tolerance;              ///< length that two segments may share at a common end
};

/// The total length of ascending, disjoint runs.
double length_of(const std::vector<glm::dvec2>& runs);
/// Joins runs that overlap; ascending.
std::vector<glm::dvec2> joined(std::vector<glm::dvec2> runs);
double shared_length(const std::vector<glm::dvec2>& some, const std::vector<glm::dvec2>& others);

class TraceFollow {
public:
    /// Keeps references to all three.
    TraceFollow(const TraceGraph& truth, const TraceCourse& course, const TraceMatch& match, double slack);

    /// For each segment of the truth that is followed, the segments of the trace that follow it.
    const std::map<size_t, std::vector<Follower>>& followers() const { return followers_; }
    /// The segments of the truth that a segment of the trace follows, without duplicates.
    const std::vector<size_t>& followed_by(size_t segment) const { return followed_by_[segment]; }
    /// The total length of the parts of the truth that a segment of the trace follows.
    double length_followed(size_t segment) const { return lengths_[segment]; }
    /// Segments of the trace that leave the truth, or switch to a segment of the truth that does not begin there.
    const std::set<size_t>& wrong() const { return wrong_; }
    /// Segments of the trace that follow a part of the truth already followed by another segment of the trace.
    const std::set<size_t>& doubled() const { return doubled_; }

private:
    std::vector<TraceCourse::Near> follow(const std::vector<TraceSample>& samples) const;
    bool goes_over(size_t a, size_t b, const TraceSample& sample) const;
    bool add_follower(size_t index);
    void note_doubled(std::vector<Follower>& followers);
    bool doubles(const Follower& a, const Follower& b) const;

    const TraceGraph& truth_;
    const TraceCourse& course_;
    const TraceMatch& match_;
    double slack_;
    std::map<size_t, std::vector<Follower>> followers_;
    std::vector<std::vector<size_t>> followed_by_;
    std::vector<double> lengths_;
    std::set<size_t> wrong_, doubled_;
};

}  // namespace shvr
