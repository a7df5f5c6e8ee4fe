// Comparison of two traces as graphs. trace_score.h defines the counts.

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <set>
#include <tuple>

#include "engine/annotation/measures/trace_course.h"
#include "engine/annotation/measures/trace_score.h"

namespace shvr {

namespace {

size_t degree(const TraceGraph& trace, uint32_t node)
{
    return trace.internodes_of(node).size();
}

/// The kind of a node: branches pair with branches first, ends with ends.
int kind_of(const TraceGraph& trace, uint32_t node)
{
    return int(std::min<size_t>(degree(trace, node), 3));
}

class Comparison {
public:
    Comparison(const TraceGraph& trace, const TraceGraph& truth, double slack)
        : trace_(trace), truth_(truth), slack_(slack), course_(truth)
    {
        for (const auto& [number, node] : trace.nodes()) largest_radius_ = std::max(largest_radius_, node.radius);
        pair_nodes();
        find_near();
    }

    TraceComparison result()
    {
        TraceComparison result;
        result.segments_total = int64_t(course_.segments().size());
        for (size_t s = 0; s < course_.segments().size(); ++s) result.segments_found += is_found(s);
        count_errors(result);
        result.gaps = count_gaps();
        measure_distance(result);
        return result;
    }

private:
    /// Distance between samples: about half of what still counts as near.
    double step_of(const TraceInternode& internode) const
    {
        const double radius = std::min(trace_.radius_of(internode, 0.0), trace_.radius_of(internode, 1.0));
        return std::max({(radius + slack_) / 2.0, trace_.length_of(internode) / 64.0, 1e-300});
    }

    /// Pairs each branch or end of the truth with at most one node of the trace, and no node twice.
    void pair_nodes()
    {
        TraceIndex index;
        for (const auto& [number, node] : trace_.nodes()) index.set(number, node.position);
        std::vector<std::tuple<bool, double, uint32_t, uint32_t>> pairs;  // kinds differ, distance, truth, trace
        for (const auto& [key, node] : truth_.nodes()) {
            if (degree(truth_, key) == 2 || degree(truth_, key) == 0) continue;
            for (const uint32_t near : index.within(node.position, node.radius + largest_radius_ + slack_)) {
                const double distance = glm::length(trace_.node(near).position - node.position);
                if (distance <= node.radius + trace_.node(near).radius + slack_)
                    pairs.emplace_back(kind_of(truth_, key) != kind_of(trace_, near), distance, key, near);
            }
        }
        std::sort(pairs.begin(), pairs.end());
        for (const auto& [other_kind, distance, key, near] : pairs) {
            if (paired_.contains(key) || stops_.contains(near)) continue;
            paired_.emplace(key, near);
            stops_.insert(near);
        }
    }

    /// Finds, for each segment of the truth, the internodes of the trace that stay near it.
    void find_near()
    {
        near_.resize(course_.segments().size());
        for (const auto& [number, internode] : trace_.internodes()) {
            std::optional<std::set<size_t>> always;
            for (const TraceSample& sample : samples_of(trace_, internode, step_of(internode))) {
                std::set<size_t> here;
                for (const TraceCourse::Near& near : course_.near(sample, slack_))
                    if (!always || always->contains(near.segment)) here.insert(near.segment);
                always = std::move(here);
            }
            for (const size_t segment : *always) near_[segment].push_back(number);
        }
    }

    bool is_found(size_t s) const
    {
        const TraceSegment& segment = course_.segments()[s];
        if (segment.is_loop()) {
            const bool has_key = degree(truth_, segment.nodes.front()) != 2;
            if (has_key && !paired_.contains(segment.nodes.front())) return false;
            return covers(s, core_of(near_[s]));
        }
        const auto from = paired_.find(segment.nodes.front()), to = paired_.find(segment.nodes.back());
        if (from == paired_.end() || to == paired_.end()) return false;
        return covers(s, ways_between(near_[s], from->second, to->second));
    }

    /// The internodes of all paths between two nodes that use only `internodes` and pass no other paired node; empty if
    /// there is no such path.
    std::vector<uint32_t> ways_between(const std::vector<uint32_t>& internodes, uint32_t from, uint32_t to) const
    {
        std::set<uint32_t> reached{from}, passed;
        std::deque<uint32_t> waiting{from};
        while (!waiting.empty()) {
            const uint32_t node = waiting.front();
            waiting.pop_front();
            if (node != from && stops_.contains(node)) continue;
            for (const uint32_t number : trace_.internodes_of(node)) {
                if (!std::ranges::binary_search(internodes, number)) continue;
                passed.insert(number);
                const uint32_t next = trace_.internode(number).other(node);
                if (reached.insert(next).second) waiting.push_back(next);
            }
        }
        if (!reached.contains(to)) return {};
        return core_of({passed.begin(), passed.end()}, {from, to});
    }

    /// The internodes left after removing loose ends, except `kept` ones, repeatedly.
    std::vector<uint32_t> core_of(const std::vector<uint32_t>& internodes, const std::set<uint32_t>& kept = {}) const
    {
        std::map<uint32_t, std::set<uint32_t>> ends;
        for (const uint32_t number : internodes)
            for (const uint32_t node : {trace_.internode(number).a, trace_.internode(number).b})
                ends[node].insert(number);
        std::deque<uint32_t> loose;
        const auto note_if_loose = [&](uint32_t node) {
            if (ends[node].size() == 1 && !kept.contains(node)) loose.push_back(node);
        };
        for (const auto& [node, numbers] : ends) note_if_loose(node);
        std::set<uint32_t> core(internodes.begin(), internodes.end());
        while (!loose.empty()) {
            const uint32_t node = loose.front();
            loose.pop_front();
            if (ends[node].size() != 1) continue;
            const uint32_t number = *ends[node].begin(), other = trace_.internode(number).other(node);
            core.erase(number);
            ends[node].clear();
            ends[other].erase(number);
            note_if_loose(other);
        }
        return {core.begin(), core.end()};
    }

    /// Whether these internodes come near every point of a segment.
    bool covers(size_t s, const std::vector<uint32_t>& internodes) const
    {
        if (internodes.empty()) return false;
        TraceGraph part;
        for (const uint32_t number : internodes) {
            const TraceInternode& internode = trace_.internode(number);
            for (const uint32_t node : {internode.a, internode.b})
                if (!part.nodes().contains(node))
                    part.apply(TraceNodeChange{node, {}, trace_.node(node)}, Direction::forwards);
            part.apply(TraceInternodeChange{number, {}, internode}, Direction::forwards);
        }
        const TraceCourse course(part);
        for (const uint32_t number : course_.segments()[s].internodes) {
            const TraceInternode& internode = truth_.internode(number);
            const double radius = std::min(truth_.radius_of(internode, 0.0), truth_.radius_of(internode, 1.0));
            const double step = std::max({(radius + slack_) / 2.0, truth_.length_of(internode) / 64.0, 1e-300});
            for (const TraceSample& sample : samples_of(truth_, internode, step))
                if (course.near(sample, slack_).empty()) return false;
        }
        return true;
    }

    /// A part of a segment of the truth that a segment of the trace follows.
    struct Stretch {
        size_t trace_segment;
        uint32_t low_end, high_end;  ///< of the trace's segment
        double from, to, tolerance;
    };

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

    /// Whether `b` is the same segment as `a`, or meets it in a node near the sample.
    bool goes_over(size_t a, size_t b, const TraceSample& sample) const
    {
        if (a == b) return true;
        const TraceSegment &from = course_.segments()[a], &to = course_.segments()[b];
        for (const uint32_t end : {from.nodes.front(), from.nodes.back()}) {
            if (end != to.nodes.front() && end != to.nodes.back()) continue;
            const TraceNode& node = truth_.node(end);
            // A step on either side belongs to the meeting point.
            const double reach = sample.radius + node.radius + slack_ + (sample.radius + slack_) / 2.0;
            if (glm::length(node.position - sample.position) <= reach) return true;
        }
        return false;
    }

    void count_errors(TraceComparison& result)
    {
        const std::vector<TraceSegment> segments = segments_of(trace_, stops_);
        std::map<size_t, std::vector<Stretch>> stretches;
        for (size_t index = 0; index < segments.size(); ++index) {
            const TraceSegment& segment = segments[index];
            std::vector<TraceSample> samples;
            for (size_t i = 0; i < segment.internodes.size(); ++i) {
                const TraceInternode& internode = trace_.internode(segment.internodes[i]);
                std::vector<TraceSample> some = samples_of(trace_, internode, step_of(internode));
                if (internode.a != segment.nodes[i]) std::reverse(some.begin(), some.end());
                samples.insert(samples.end(), some.begin(), some.end());
            }
            const std::vector<TraceCourse::Near> followed = follow(samples);
            if (followed.empty()) {
                ++result.wrong;
                continue;
            }
            const auto [low, high] = std::minmax(segment.nodes.front(), segment.nodes.back());
            for (size_t i = 0; i < followed.size(); ++i) {
                std::vector<Stretch>& along = stretches[followed[i].segment];
                if (along.empty() || along.back().trace_segment != index)
                    along.push_back({index, low, high, followed[i].along, followed[i].along, 0.0});
                Stretch& stretch = along.back();
                stretch.from = std::min(stretch.from, followed[i].along);
                stretch.to = std::max(stretch.to, followed[i].along);
                stretch.tolerance = std::max(stretch.tolerance, 2.0 * samples[i].radius + slack_);
            }
        }
        for (auto& [segment, along] : stretches) result.doubled += count_doubled(along);
    }

    /// Counts stretches that overlap beyond the surroundings of their ends, or that join the same two nodes.
    static int64_t count_doubled(std::vector<Stretch>& along)
    {
        std::ranges::sort(along, {}, &Stretch::from);
        int64_t doubled = 0;
        for (size_t b = 0; b < along.size(); ++b)
            for (size_t a = 0; a < b; ++a) {
                const double shared = std::min(along[a].to, along[b].to) - along[b].from;
                const bool same_ends = along[a].low_end == along[b].low_end && along[a].high_end == along[b].high_end &&
                                       along[a].low_end != along[a].high_end && shared > 0.0;
                if (!same_ends && shared <= 2.0 * std::max(along[a].tolerance, along[b].tolerance)) continue;
                ++doubled;
                break;
            }
        return doubled;
    }

    int64_t count_gaps() const
    {
        TraceIndex keys;
        double largest = 0.0;
        for (const auto& [key, node] : paired_) {
            if (degree(truth_, key) < 3) continue;
            keys.set(key, truth_.node(key).position);
            largest = std::max(largest, truth_.node(key).radius);
        }
        int64_t gaps = 0;
        for (const auto& [number, node] : trace_.nodes()) {
            if (degree(trace_, number) != 1 || stops_.contains(number)) continue;
            const TraceSegment segment = segment_through(trace_, trace_.internodes_of(number)[0], stops_);
            const uint32_t other = segment.nodes.front() == number ? segment.nodes.back() : segment.nodes.front();
            for (const uint32_t key : keys.within(node.position, node.radius + largest + slack_)) {
                const TraceNode& truth = truth_.node(key);
                if (glm::length(truth.position - node.position) > node.radius + truth.radius + slack_) continue;
                if (other == paired_.at(key)) continue;  // it only begins there
                ++gaps;
                break;
            }
        }
        return gaps;
    }

    void measure_distance(TraceComparison& result) const
    {
        constexpr int PARTS = 16;  // samples of each internode, at the middle of each part
        double sum = 0.0, length_sum = 0.0, most = 0.0;
        for (const auto& [number, internode] : trace_.internodes()) {
            const glm::dvec3 a = trace_.node(internode.a).position, b = trace_.node(internode.b).position;
            const double length = glm::length(b - a) / PARTS;
            for (int part = 0; part < PARTS; ++part) {
                const double t = (part + 0.5) / PARTS;
                const double distance = course_.distance_to((1.0 - t) * a + t * b);
                sum += length * distance * distance;
                length_sum += length;
                most = std::max(most, distance);
            }
        }
        if (length_sum == 0.0 || course_.segments().empty()) return;
        result.centreline_rms = std::sqrt(sum / length_sum);
        result.centreline_most = most;
    }

    const TraceGraph &trace_, &truth_;
    double slack_;
    TraceCourse course_;  ///< of the truth
    double largest_radius_ = 0.0;
    std::map<uint32_t, uint32_t> paired_;  ///< branch or end of the truth -> node of the trace
    std::set<uint32_t> stops_;             ///< those nodes of the trace
    std::vector<std::vector<uint32_t>> near_;
};

}  // namespace

TraceComparison compare(const TraceGraph& trace, const TraceGraph& truth, double slack)
{
    return Comparison(trace, truth, slack).result();
}

}  // namespace shvr
