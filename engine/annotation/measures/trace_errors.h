#pragma once
// Counts the errors of segments of a trace that follow the truth: spurs, superfluous segments, breaks and unjoined ends
// (trace_score.h defines these terms). Any thread may query.

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "engine/annotation/measures/trace_follow.h"

namespace shvr {

class TraceErrors {
public:
    struct Compared {
        const TraceGraph &trace, &truth;
        const TraceCourse& course;  ///< the truth's
        const TraceMatch& match;
        const TraceFollow& follow;
        double slack;
    };
    explicit TraceErrors(const Compared& compared);

    int64_t spurs() const { return spurs_; }
    int64_t superfluous() const { return superfluous_; }
    int64_t count_breaks() const;
    int64_t count_gaps() const;

private:
    /// Followers of one segment of the truth that are joined to each other, and the part of that segment they cover.
    struct Piece {
        std::vector<size_t> segments;
        glm::dvec2 extent;
    };
    size_t degree(uint32_t node) const { return ends_.contains(node) ? ends_.at(node).size() : 0; }
    bool is_loose(uint32_t node) const { return degree(node) == 1 && !with_.match.stops().contains(node); }
    void leave_out(size_t segment);
    void leave_out_superfluous();
    bool note_superfluous(size_t segment);
    bool is_needed(size_t segment) const;
    bool passes_by(size_t truth_segment, const Follower& follower) const;
    std::vector<Piece> pieces_along(size_t truth_segment, std::optional<size_t> without = {}) const;

    void note_ends_near_branches(std::set<uint32_t>& unjoined) const;
    void note_ends_before_branches(std::set<uint32_t>& unjoined) const;
    void note_branches_passed(std::set<uint32_t>& unjoined) const;
    std::optional<uint32_t> loose_end_nearest(const Piece& piece, const glm::dvec3& position) const;
    bool is_attached(const Piece& piece, size_t truth_segment, uint32_t branch) const;
    std::set<size_t> passing(uint32_t branch) const;

    Compared with_;
    std::set<size_t> left_out_;                          ///< segments of the trace that are counted as errors
    std::map<uint32_t, std::multiset<size_t>> ends_;     ///< node of the trace -> segments that end there and are kept
    std::map<uint32_t, std::vector<size_t>> at_branch_;  ///< branch of the truth -> segments of the truth there
    int64_t spurs_ = 0, superfluous_ = 0;
};

}  // namespace shvr
