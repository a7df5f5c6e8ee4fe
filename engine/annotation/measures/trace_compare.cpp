// Comparison of two traces as graphs. trace_score.h defines the counts.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "engine/annotation/measures/trace_course.h"
#include "engine/annotation/measures/trace_distance.h"
#include "engine/annotation/measures/trace_match.h"
#include "engine/annotation/measures/trace_score.h"

namespace shvr {

namespace {

/// The parts of one segment of the truth that a segment of the trace follows.
struct Follower {
    size_t segment;  ///< index in the trace
    bool is_partner;
    std::vector<glm::dvec2> runs;  ///< from ... to along the truth's segment, ascending and disjoint
    double tolerance;              ///< length that two segments may share where they meet
};

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

class Comparison {
public:
    Comparison(const TraceGraph& trace, const TraceGraph& truth, double slack)
        : trace_(trace), truth_(truth), slack_(slack), course_(truth), match_(trace, truth, course_, slack)
    {}

    TraceComparison result()
    {
        TraceComparison result;
        result.segments_total = int64_t(course_.segments().size());
        for (size_t s = 0; s < course_.segments().size(); ++s) result.segments_found += match_.is_found(s);
        count_errors(result);
        result.gaps = count_gaps();
        if (const std::optional<TraceDistance> distance = distance_from(trace_, course_)) {
            result.centreline_rms = distance->root_mean_square;
            result.centreline_most = distance->greatest;
        }
        return result;
    }

private:
    /// Assigns each sample of a segment to a segment of the truth: among all assignments that change segments only
    /// where the truth does, the one with the smallest sum of squared distances (Viterbi 1967). Empty if there is none.
    std::vector<TraceCourse::Near> follow(const std::vector<TraceSample>& samples) const
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

    /// Returns whether `b` is the same segment as `a`, or meets it in a node near the sample.
    bool goes_over(size_t a, size_t b, const TraceSample& sample) const
    {
        if (a == b) return true;
        const TraceSegment &from = course_.segments()[a], &to = course_.segments()[b];
        for (const uint32_t end : {from.nodes.front(), from.nodes.back()}) {
            if (end != to.nodes.front() && end != to.nodes.back()) continue;
            const TraceNode& node = truth_.node(end);
            // A step on either side counts as part of the meeting point.
            const double reach = sample.radius + node.radius + slack_ + (sample.radius + slack_) / 2.0;
            if (glm::length(node.position - sample.position) <= reach) return true;
        }
        return false;
    }

    /// Records what a segment of the trace follows; false if it cannot follow the truth.
    bool add_follower(size_t index, std::map<size_t, std::vector<Follower>>& followers)
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
            followers[truth].push_back({index, partner.has_value(), joined(std::move(along)), tolerance});
            followed_[index] += length_of(followers[truth].back().runs);
        }
        return true;
    }

    void count_errors(TraceComparison& result)
    {
        followed_.assign(match_.segments().size(), 0.0);
        std::map<size_t, std::vector<Follower>> followers;
        for (size_t index = 0; index < match_.segments().size(); ++index)
            result.wrong += !add_follower(index, followers);
        std::set<size_t> doubled;
        for (auto& [truth, some] : followers) note_doubled(some, doubled);
        result.doubled = int64_t(doubled.size());
    }

    /// Marks segments of the trace that follow a part which an earlier segment follows, too. The segment matched to the
    /// one of the truth comes first and is never marked.
    void note_doubled(std::vector<Follower>& followers, std::set<size_t>& doubled) const
    {
        std::ranges::sort(followers, [](const Follower& a, const Follower& b) {
            return std::tuple(!a.is_partner, a.runs.front().x) < std::tuple(!b.is_partner, b.runs.front().x);
        });
        for (size_t b = 0; b < followers.size(); ++b) {
            if (followers[b].is_partner) continue;
            const auto before = followers.begin() + std::ptrdiff_t(b);
            if (std::any_of(followers.begin(), before, [&](const Follower& a) { return doubles(a, followers[b]); }))
                doubled.insert(followers[b].segment);
        }
    }

    /// Returns whether two segments overlap: they share more than the surroundings of their ends or, if they join the
    /// same two nodes, at least half of what the shorter one follows.
    bool doubles(const Follower& a, const Follower& b) const
    {
        const double shared = shared_length(a.runs, b.runs);
        if (shared > 2.0 * std::max(a.tolerance, b.tolerance)) return true;
        const auto ends_of = [&](const Follower& follower) {
            const TraceSegment& segment = match_.segments()[follower.segment];
            return std::minmax({segment.nodes.front(), segment.nodes.back()});
        };
        return shared > 0.0 && ends_of(a) == ends_of(b) &&
               shared >= 0.5 * std::min(followed_[a.segment], followed_[b.segment]);
    }

    int64_t count_gaps() const
    {
        TraceIndex keys;
        double largest = 0.0;
        for (const auto& [key, node] : match_.paired()) {
            if (truth_.internodes_of(key).size() < 3) continue;
            keys.set(key, truth_.node(key).position);
            largest = std::max(largest, truth_.node(key).radius);
        }
        int64_t gaps = 0;
        for (const auto& [number, node] : trace_.nodes()) {
            if (trace_.internodes_of(number).size() != 1 || match_.stops().contains(number)) continue;
            const TraceSegment segment = segment_through(trace_, trace_.internodes_of(number)[0], match_.stops());
            const uint32_t other = segment.nodes.front() == number ? segment.nodes.back() : segment.nodes.front();
            for (const uint32_t key : keys.within(node.position, node.radius + largest + slack_)) {
                const TraceNode& truth = truth_.node(key);
                if (glm::length(truth.position - node.position) > node.radius + truth.radius + slack_) continue;
                if (other == match_.paired().at(key)) continue;  // it only begins there
                ++gaps;
                break;
            }
        }
        return gaps;
    }

    const TraceGraph &trace_, &truth_;
    double slack_;
    TraceCourse course_;  ///< course of the truth
    TraceMatch match_;
    std::vector<double> followed_;  ///< per segment of the trace: the total length that it follows
};

}  // namespace

TraceComparison compare(const TraceGraph& trace, const TraceGraph& truth, double slack)
{
    return Comparison(trace, truth, slack).result();
}

}  // namespace shvr
