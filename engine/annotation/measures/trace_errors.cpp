#include "engine/annotation/measures/trace_errors.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace shvr {

namespace {

double length_along(const TraceGraph& trace, const TraceSegment& segment)
{
    double length = 0.0;
    for (const uint32_t number : segment.internodes) length += trace.length_of(trace.internode(number));
    return length;
}

bool ends_at(const TraceSegment& segment, uint32_t node)
{
    return segment.nodes.front() == node || segment.nodes.back() == node;
}

}  // namespace

TraceErrors::TraceErrors(const Compared& compared) : with_(compared)
{
    for (size_t s = 0; s < with_.match.segments().size(); ++s)
        for (const uint32_t node : {with_.match.segments()[s].nodes.front(), with_.match.segments()[s].nodes.back()})
            ends_[node].insert(s);
    for (size_t s = 0; s < with_.course.segments().size(); ++s) {
        const TraceSegment& segment = with_.course.segments()[s];
        for (const uint32_t node : std::set{segment.nodes.front(), segment.nodes.back()})
            if (with_.truth.internodes_of(node).size() >= 3) at_branch_[node].push_back(s);
    }
    for (const size_t segment : with_.follow.wrong()) leave_out(segment);
    for (const size_t segment : with_.follow.doubled()) leave_out(segment);
    leave_out_superfluous();
}

void TraceErrors::leave_out(size_t segment)
{
    if (!left_out_.insert(segment).second) return;
    const TraceSegment& one = with_.match.segments()[segment];
    for (const uint32_t node : {one.nodes.front(), one.nodes.back()}) ends_[node].erase(segment);
}

/// Examines the shortest segments first, so that the longer one of two interchangeable segments is kept.
void TraceErrors::leave_out_superfluous()
{
    std::vector<std::pair<double, size_t>> candidates;
    for (size_t s = 0; s < with_.match.segments().size(); ++s) {
        const TraceSegment& segment = with_.match.segments()[s];
        const auto is_end_of_truth = [&](uint32_t node) {
            return degree(node) == 1 && with_.match.stops().contains(node);
        };
        if (left_out_.contains(s) || with_.match.partner_of(s)) continue;
        if (is_end_of_truth(segment.nodes.front()) || is_end_of_truth(segment.nodes.back())) continue;
        candidates.emplace_back(length_along(with_.trace, segment), s);
    }
    std::ranges::sort(candidates);
    for (const auto& [length, segment] : candidates)
        if (!is_needed(segment) && note_superfluous(segment)) leave_out(segment);
}

/// If this segment, which is not needed, is an error, counts it and returns true.
bool TraceErrors::note_superfluous(size_t segment)
{
    const TraceSegment& one = with_.match.segments()[segment];
    const uint32_t front = one.nodes.front(), back = one.nodes.back();
    if (is_loose(front) == is_loose(back)) {
        ++superfluous_;
        return true;
    }
    // A trace may extend beyond an end of the truth if it stays in the ball of that end. This is not an error.
    if (degree(is_loose(front) ? back : front) < 3) return false;
    ++spurs_;
    return true;
}

/// Returns whether the trace needs a segment: for at least half of its length, no other segment follows the same part
/// of the truth, or it joins other segments that follow the same segment of the truth.
bool TraceErrors::is_needed(size_t segment) const
{
    double alone = 0.0;
    for (const size_t truth : with_.follow.followed_by(segment)) {
        std::vector<glm::dvec2> own, others;
        for (const Follower& follower : with_.follow.followers().at(truth)) {
            if (left_out_.contains(follower.segment)) continue;
            std::vector<glm::dvec2>& runs = follower.segment == segment ? own : others;
            runs.insert(runs.end(), follower.runs.begin(), follower.runs.end());
        }
        alone += length_of(own) - shared_length(own, joined(std::move(others)));
        if (pieces_along(truth, segment).size() > pieces_along(truth).size()) return true;
    }
    return alone >= 0.5 * length_along(with_.trace, with_.match.segments()[segment]);
}

/// Returns whether a follower only touches a segment of the truth while following other segments of the truth.
bool TraceErrors::passes_by(size_t truth_segment, const Follower& follower) const
{
    return !follower.is_partner && with_.follow.followed_by(follower.segment).size() > 1 &&
           length_of(follower.runs) <= std::min(2.0 * follower.tolerance, 0.5 * with_.course.length_of(truth_segment));
}

/// Returns the joined parts of the trace that follow a segment of the truth, sorted by their start along the segment.
std::vector<TraceErrors::Piece> TraceErrors::pieces_along(size_t truth_segment, std::optional<size_t> without) const
{
    std::map<uint32_t, std::vector<size_t>> at;  // node -> indices into `pieces`
    std::vector<Piece> pieces;
    for (const Follower& follower : with_.follow.followers().at(truth_segment)) {
        if (left_out_.contains(follower.segment) || follower.segment == without) continue;
        if (passes_by(truth_segment, follower)) continue;
        const TraceSegment& segment = with_.match.segments()[follower.segment];
        for (const uint32_t node : {segment.nodes.front(), segment.nodes.back()}) at[node].push_back(pieces.size());
        pieces.push_back({{follower.segment}, {follower.runs.front().x, follower.runs.back().y}});
    }
    std::vector<size_t> root(pieces.size());
    std::iota(root.begin(), root.end(), size_t{0});
    const auto root_of = [&](size_t i) {
        while (root[i] != i) i = root[i];
        return i;
    };
    for (const auto& [node, some] : at)
        for (const size_t i : some) {
            const size_t a = root_of(some.front()), b = root_of(i);
            if (a == b) continue;
            root[b] = a;
            pieces[a].segments.insert(pieces[a].segments.end(), pieces[b].segments.begin(), pieces[b].segments.end());
            pieces[a].extent = {std::min(pieces[a].extent.x, pieces[b].extent.x),
                                std::max(pieces[a].extent.y, pieces[b].extent.y)};
        }
    std::vector<Piece> joined_pieces;
    for (size_t i = 0; i < pieces.size(); ++i)
        if (root[i] == i) joined_pieces.push_back(std::move(pieces[i]));
    std::ranges::sort(joined_pieces, {}, [](const Piece& piece) { return piece.extent.x; });
    return joined_pieces;
}

int64_t TraceErrors::count_breaks() const
{
    int64_t breaks = 0;
    for (const auto& [truth, followers] : with_.follow.followers()) {
        if (with_.match.is_found(truth)) continue;
        const TraceSegment& segment = with_.course.segments()[truth];
        const bool is_ring = segment.is_loop() && !at_branch_.contains(segment.nodes.front());
        const auto pieces = int64_t(pieces_along(truth).size());
        breaks += is_ring ? pieces : std::max<int64_t>(pieces - 1, 0);
    }
    return breaks;
}

int64_t TraceErrors::count_gaps() const
{
    std::set<uint32_t> unjoined;  // nodes of the trace
    note_ends_near_branches(unjoined);
    note_ends_before_branches(unjoined);
    note_branches_passed(unjoined);
    return int64_t(unjoined.size());
}

/// Notes ends near a traced branch.
void TraceErrors::note_ends_near_branches(std::set<uint32_t>& unjoined) const
{
    TraceIndex branches;
    double largest = 0.0;
    for (const auto& [branch, node] : with_.match.paired()) {
        if (!at_branch_.contains(branch)) continue;
        branches.set(branch, with_.truth.node(branch).position);
        largest = std::max(largest, with_.truth.node(branch).radius);
    }
    for (const auto& [number, node] : with_.trace.nodes()) {
        if (with_.trace.internodes_of(number).size() != 1 || !is_loose(number)) continue;
        const TraceSegment& segment = with_.match.segments()[*ends_.at(number).begin()];
        const uint32_t other = segment.nodes.front() == number ? segment.nodes.back() : segment.nodes.front();
        for (const uint32_t branch : branches.within(node.position, node.radius + largest + with_.slack)) {
            const TraceNode& truth = with_.truth.node(branch);
            if (glm::length(truth.position - node.position) > node.radius + truth.radius + with_.slack) continue;
            if (other == with_.match.paired().at(branch)) continue;  // it only begins there
            unjoined.insert(number);
            break;
        }
    }
}

/// Notes ends of the trace on the way to a traced branch if nothing is traced between the end and the branch.
void TraceErrors::note_ends_before_branches(std::set<uint32_t>& unjoined) const
{
    for (const auto& [branch, segments] : at_branch_) {
        if (!with_.match.paired().contains(branch) && passing(branch).empty()) continue;
        for (const size_t truth : segments) {
            if (!with_.follow.followers().contains(truth) || with_.match.is_found(truth)) continue;
            const std::vector<Piece> pieces = pieces_along(truth);
            if (pieces.empty()) continue;
            const bool at_front = with_.course.segments()[truth].nodes.front() == branch;
            const Piece& piece =
                at_front ? pieces.front()
                         : *std::ranges::max_element(pieces, {}, [](const Piece& one) { return one.extent.y; });
            if (is_attached(piece, truth, branch)) continue;
            if (const std::optional<uint32_t> node = loose_end_nearest(piece, with_.truth.node(branch).position))
                unjoined.insert(*node);
        }
    }
}

std::optional<uint32_t> TraceErrors::loose_end_nearest(const Piece& piece, const glm::dvec3& position) const
{
    std::optional<uint32_t> nearest;
    double least = 0.0;
    for (const size_t s : piece.segments) {
        const TraceSegment& segment = with_.match.segments()[s];
        for (const uint32_t node : {segment.nodes.front(), segment.nodes.back()}) {
            const double away = glm::length(with_.trace.node(node).position - position);
            if (!is_loose(node) || (nearest && away >= least)) continue;
            nearest = node;
            least = away;
        }
    }
    return nearest;
}

/// Returns whether a piece is joined to other segments at a branch of the truth.
bool TraceErrors::is_attached(const Piece& piece, size_t truth_segment, uint32_t branch) const
{
    const auto paired = with_.match.paired().find(branch);
    return std::ranges::any_of(piece.segments, [&](size_t s) {
        if (paired != with_.match.paired().end() && ends_at(with_.match.segments()[s], paired->second)) return true;
        return std::ranges::any_of(with_.follow.followed_by(s), [&](size_t other) {
            return other != truth_segment &&
                   std::ranges::find(at_branch_.at(branch), other) != at_branch_.at(branch).end();
        });
    });
}

/// Returns the trace's segments that pass a branch: they follow two of its segments, but miss the node paired with it.
std::set<size_t> TraceErrors::passing(uint32_t branch) const
{
    std::map<size_t, int> followed;
    for (const size_t truth : at_branch_.at(branch)) {
        const auto found = with_.follow.followers().find(truth);
        if (found == with_.follow.followers().end()) continue;
        for (const Follower& follower : found->second)
            if (!left_out_.contains(follower.segment) && !passes_by(truth, follower)) ++followed[follower.segment];
    }
    const auto paired = with_.match.paired().find(branch);
    std::set<size_t> segments;
    for (const auto& [segment, times] : followed)
        if (times > 1 &&
            (paired == with_.match.paired().end() || !ends_at(with_.match.segments()[segment], paired->second)))
            segments.insert(segment);
    return segments;
}

/// Notes ends that are paired with a branch although another segment, which is not joined to them, passes the branch.
void TraceErrors::note_branches_passed(std::set<uint32_t>& unjoined) const
{
    for (const auto& [branch, node] : with_.match.paired())
        if (at_branch_.contains(branch) && degree(node) == 1 && !passing(branch).empty()) unjoined.insert(node);
}

}  // namespace shvr
