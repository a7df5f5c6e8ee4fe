#include "engine/annotation/measures/trace_follow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace shvr {

double length_of(const std::vector<glm::dvec2>& runs)
{
    double length = 0.0;
    for (const glm::dvec2& run : runs) length += run.y - run.x;
    return length;
}

/// Joins runs that overlap.
std::vector<glm::dvec2> joined(std::vector<glm::dvec2> runs)
{
    std::ranges::sort(runs, {}, &glm::dvec2::x);
    std::vector<glm::dvec2> disjoint;
    for (const glm::dvec2& run : runs)
        if (disjoint.empty() || run.x > disjoint.back().y)
            disjoint.push_back(run);
        else
            disjoint.back().y = std::max(disjoint.back().y, run.y);
    return disjoint;
}

double shared_length(const std::vector<glm::dvec2>& some, const std::vector<glm::dvec2>& others)
{
    double shared = 0.0;
    for (const glm::dvec2& a : some)
        for (const glm::dvec2& b : others) shared += std::max(0.0, std::min(a.y, b.y) - std::max(a.x, b.x));
    return shared;
}

TraceFollow::TraceFollow(const TraceGraph& truth, const TraceCourse& course, const TraceMatch& match, double slack)
    : truth_(truth),
      course_(course),
      match_(match),
      slack_(slack),
      followed_by_(match.segments().size()),
      lengths_(match.segments().size(), 0.0)
{
    for (size_t index = 0; index < match_.segments().size(); ++index)
        if (!add_follower(index)) wrong_.insert(index);
    for (auto& [truth_segment, some] : followers_) note_doubled(some);
}

/// Assigns each sample of a segment to a segment of the truth. Among all assignments that change segments only at nodes
/// of the truth, returns the one with the smallest sum of squared distances (Viterbi 1967). Empty if there is none.
std::vector<TraceCourse::Near> TraceFollow::follow(const std::vector<TraceSample>& samples) const
{
    struct State {
        TraceCourse::Near near;
        double cost;
        size_t before;
    };
    std::vector<std::vector<State>> columns;
    for (const TraceSample& sample : samples) {
        std::vector<State> column;
        for (const TraceCourse::Near& near : course_.near(sample, slack_)) {
            State state{near, columns.empty() ? 0.0 : std::numeric_limits<double>::infinity(), 0};
            for (size_t i = 0; !columns.empty() && i < columns.back().size(); ++i) {
                const State& before = columns.back()[i];
                if (before.cost < state.cost && goes_over(before.near.segment, near.segment, sample)) {
                    state.cost = before.cost;
                    state.before = i;
                }
            }
            state.cost += near.distance * near.distance;
            if (std::isfinite(state.cost)) column.push_back(state);
        }
        if (column.empty()) return {};
        columns.push_back(std::move(column));
    }
    std::vector<TraceCourse::Near> followed(samples.size());
    size_t at = size_t(std::ranges::min_element(columns.back(), {}, &State::cost) - columns.back().begin());
    for (size_t i = samples.size(); i-- > 0;) {
        followed[i] = columns[i][at].near;
        at = columns[i][at].before;
    }
    return followed;
}

/// Returns whether `b` is the same segment as `a`, or shares a node with `a` near the sample.
bool TraceFollow::goes_over(size_t a, size_t b, const TraceSample& sample) const
{
    if (a == b) return true;
    const TraceSegment &from = course_.segments()[a], &to = course_.segments()[b];
    for (const uint32_t end : {from.nodes.front(), from.nodes.back()}) {
        if (end != to.nodes.front() && end != to.nodes.back()) continue;
        const TraceNode& node = truth_.node(end);
        // Allows one step between samples on either side of the place where the segments meet.
        const double reach = sample.radius + node.radius + slack_ + (sample.radius + slack_) / 2.0;
        if (glm::length(node.position - sample.position) <= reach) return true;
    }
    return false;
}

/// Records which parts of the truth a segment of the trace follows; returns false if it follows no part.
bool TraceFollow::add_follower(size_t index)
{
    const std::vector<TraceSample> samples = match_.samples_along(match_.segments()[index]);
    double tolerance = 0.0;
    for (const TraceSample& sample : samples) tolerance = std::max(tolerance, 2.0 * sample.radius + slack_);
    std::map<size_t, std::vector<glm::dvec2>> runs;
    const std::optional<size_t> partner = match_.partner_of(index);
    if (partner) {
        runs[*partner] = {{0.0, course_.length_of(*partner)}};
    } else {
        const std::vector<TraceCourse::Near> followed = follow(samples);
        if (followed.empty()) return false;
        for (size_t i = 0; i < followed.size(); ++i) {
            std::vector<glm::dvec2>& along = runs[followed[i].segment];
            if (i == 0 || followed[i].segment != followed[i - 1].segment) along.emplace_back(followed[i].along);
            along.back().x = std::min(along.back().x, followed[i].along);
            along.back().y = std::max(along.back().y, followed[i].along);
        }
    }
    for (auto& [truth, along] : runs) {
        followers_[truth].push_back({index, partner.has_value(), joined(std::move(along)), tolerance});
        followed_by_[index].push_back(truth);
        lengths_[index] += length_of(followers_[truth].back().runs);
    }
    return true;
}

/// Marks followers whose part of the truth is also followed by an earlier entry of `followers`. The segment of the
/// trace that stands for this segment of the truth is sorted first and never marked.
void TraceFollow::note_doubled(std::vector<Follower>& followers)
{
    std::ranges::sort(followers, [](const Follower& a, const Follower& b) {
        return std::tuple(!a.is_partner, a.runs.front().x) < std::tuple(!b.is_partner, b.runs.front().x);
    });
    for (size_t b = 0; b < followers.size(); ++b) {
        if (followers[b].is_partner) continue;
        const auto before = followers.begin() + std::ptrdiff_t(b);
        if (std::any_of(followers.begin(), before, [&](const Follower& a) { return doubles(a, followers[b]); }))
            doubled_.insert(followers[b].segment);
    }
}

/// Returns whether two segments overlap: they share more than the surroundings of their ends or, if they join the same
/// two nodes, at least half of the part of the truth that the shorter one follows.
bool TraceFollow::doubles(const Follower& a, const Follower& b) const
{
    const double shared = shared_length(a.runs, b.runs);
    if (shared > 2.0 * std::max(a.tolerance, b.tolerance)) return true;
    const auto ends_of = [&](const Follower& follower) {
        const TraceSegment& segment = match_.segments()[follower.segment];
        return std::minmax({segment.nodes.front(), segment.nodes.back()});
    };
    return shared > 0.0 && ends_of(a) == ends_of(b) &&
           shared >= 0.5 * std::min(lengths_[a.segment], lengths_[b.segment]);
}

}  // namespace shvr
