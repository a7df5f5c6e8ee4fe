#include "engine/annotation/measures/trace_match.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <tuple>

namespace shvr {

namespace {

size_t degree(const TraceGraph& trace, uint32_t node)
{
    return trace.internodes_of(node).size();
}

/// Kind of a node for matching: branches (3) are paired with branches first, ends (1) with ends.
int kind_of(const TraceGraph& trace, uint32_t node)
{
    return int(std::min<size_t>(degree(trace, node), 3));
}

/// Spacing of samples along an internode: about half of the distance that counts as near.
double step_along(const TraceGraph& trace, const TraceInternode& internode, double slack)
{
    const double radius = std::min(trace.radius_of(internode, 0.0), trace.radius_of(internode, 1.0));
    return std::max({(radius + slack) / 2.0, trace.length_of(internode) / 64.0, 1e-300});
}

}  // namespace

TraceMatch::TraceMatch(const TraceGraph& trace, const TraceGraph& truth, const TraceCourse& course, double slack)
    : trace_(trace), truth_(truth), course_(course), slack_(slack)
{
    pair_nodes();
    find_near();
    pair_segments();
}

void TraceMatch::pair_nodes()
{
    TraceIndex index;
    double largest_radius = 0.0;
    for (const auto& [number, node] : trace_.nodes()) {
        index.set(number, node.position);
        largest_radius = std::max(largest_radius, node.radius);
    }
    std::vector<std::tuple<bool, double, uint32_t, uint32_t>> pairs;  // kinds differ, distance, truth, trace
    for (const auto& [key, node] : truth_.nodes()) {
        if (degree(truth_, key) == 2 || degree(truth_, key) == 0) continue;
        for (const uint32_t near : index.within(node.position, node.radius + largest_radius + slack_)) {
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

/// Finds, for each internode of the trace, the segments of the truth that are near it along its whole length.
void TraceMatch::find_near()
{
    for (const auto& [number, internode] : trace_.internodes()) {
        std::optional<std::set<size_t>> always;
        for (const TraceSample& sample : samples_of(trace_, internode, step_along(trace_, internode, slack_))) {
            std::set<size_t> here;
            for (const TraceCourse::Near& near : course_.near(sample, slack_))
                if (!always || always->contains(near.segment)) here.insert(near.segment);
            always = std::move(here);
        }
        near_[number].assign(always->begin(), always->end());
    }
}

void TraceMatch::pair_segments()
{
    segments_ = segments_of(trace_, stops_);
    partners_.resize(segments_.size());
    truth_partners_.resize(course_.segments().size());
    std::vector<std::tuple<double, size_t, size_t>> pairs;  // distance, truth, trace
    for (size_t s = 0; s < segments_.size(); ++s) {
        for (const uint32_t number : segments_[s].internodes) segment_of_[number] = s;
        for (const size_t truth : near_all(segments_[s])) {
            if (!has_ends_of(segments_[s], course_.segments()[truth])) continue;
            if (const std::optional<double> distance = distance_between(segments_[s], truth))
                pairs.emplace_back(*distance, truth, s);
        }
    }
    std::sort(pairs.begin(), pairs.end());
    for (const auto& [distance, truth, s] : pairs) {
        if (partners_[s] || truth_partners_[truth]) continue;
        partners_[s] = truth;
        truth_partners_[truth] = s;
    }
}

/// Returns the segments of the truth that are near every internode of `segment`.
std::vector<size_t> TraceMatch::near_all(const TraceSegment& segment) const
{
    std::vector<size_t> all = near_.at(segment.internodes.front());
    for (const uint32_t number : segment.internodes) {
        const std::vector<size_t>& here = near_.at(number);
        std::erase_if(all, [&](size_t truth) { return !std::ranges::binary_search(here, truth); });
    }
    return all;
}

bool TraceMatch::has_ends_of(const TraceSegment& segment, const TraceSegment& truth) const
{
    const uint32_t front = segment.nodes.front(), back = segment.nodes.back();
    if (truth.is_loop() && degree(truth_, truth.nodes.front()) == 2) return front == back && !stops_.contains(front);
    const auto from = paired_.find(truth.nodes.front()), to = paired_.find(truth.nodes.back());
    if (from == paired_.end() || to == paired_.end()) return false;
    return std::minmax(front, back) == std::minmax(from->second, to->second);
}

std::vector<TraceSample> TraceMatch::samples_along(const TraceSegment& segment) const
{
    std::vector<TraceSample> samples;
    for (size_t i = 0; i < segment.internodes.size(); ++i) {
        const TraceInternode& internode = trace_.internode(segment.internodes[i]);
        std::vector<TraceSample> some = samples_of(trace_, internode, step_along(trace_, internode, slack_));
        if (internode.a != segment.nodes[i]) std::reverse(some.begin(), some.end());
        samples.insert(samples.end(), some.begin(), some.end());
    }
    return samples;
}

/// Sum of the mean squared distances in both directions; null if a part of either segment is not near the other.
std::optional<double> TraceMatch::distance_between(const TraceSegment& segment, size_t truth_segment) const
{
    std::optional<double> distance = covers(truth_segment, segment.internodes);
    if (!distance) return std::nullopt;
    const std::vector<TraceSample> samples = samples_along(segment);
    for (const TraceSample& sample : samples) {
        const std::vector<TraceCourse::Near> near = course_.near(sample, slack_);
        const auto found = std::ranges::find(near, truth_segment, &TraceCourse::Near::segment);
        if (found == near.end()) return std::nullopt;
        *distance += found->distance * found->distance / double(samples.size());
    }
    return distance;
}

bool TraceMatch::is_found(size_t truth_segment) const
{
    if (truth_partners_[truth_segment]) return true;
    const TraceSegment& segment = course_.segments()[truth_segment];
    const std::vector<uint32_t> near = free_near(truth_segment);
    if (segment.is_loop()) {
        const bool has_key = degree(truth_, segment.nodes.front()) != 2;
        if (has_key && !paired_.contains(segment.nodes.front())) return false;
        return covers(truth_segment, core_of(near)).has_value();
    }
    const auto from = paired_.find(segment.nodes.front()), to = paired_.find(segment.nodes.back());
    if (from == paired_.end() || to == paired_.end()) return false;
    return covers(truth_segment, ways_between(near, from->second, to->second)).has_value();
}

/// Internodes near a segment of the truth that are in no matched segment of the trace; ascending.
std::vector<uint32_t> TraceMatch::free_near(size_t truth_segment) const
{
    std::vector<uint32_t> internodes;
    for (const auto& [number, segments] : near_)
        if (!partners_[segment_of_.at(number)] && std::ranges::binary_search(segments, truth_segment))
            internodes.push_back(number);
    return internodes;
}

/// The internodes of all paths between two nodes that use only `internodes` and pass no other paired node. Empty if no
/// such path exists.
std::vector<uint32_t> TraceMatch::ways_between(const std::vector<uint32_t>& internodes, uint32_t from,
                                               uint32_t to) const
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

/// Removes internodes with a loose end, repeatedly, and returns the others; ends at `kept` nodes do not count as loose.
std::vector<uint32_t> TraceMatch::core_of(const std::vector<uint32_t>& internodes, const std::set<uint32_t>& kept) const
{
    std::map<uint32_t, std::set<uint32_t>> ends;
    for (const uint32_t number : internodes)
        for (const uint32_t node : {trace_.internode(number).a, trace_.internode(number).b}) ends[node].insert(number);
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

/// The mean squared distance of a segment of the truth from the internodes; null if they do not cover all of it.
std::optional<double> TraceMatch::covers(size_t truth_segment, const std::vector<uint32_t>& internodes) const
{
    if (internodes.empty()) return std::nullopt;
    TraceGraph part;
    for (const uint32_t number : internodes) {
        const TraceInternode& internode = trace_.internode(number);
        for (const uint32_t node : {internode.a, internode.b})
            if (!part.nodes().contains(node))
                part.apply(TraceNodeChange{node, {}, trace_.node(node)}, Direction::forwards);
        part.apply(TraceInternodeChange{number, {}, internode}, Direction::forwards);
    }
    const TraceCourse course(part);
    double sum = 0.0;
    size_t count = 0;
    for (const uint32_t number : course_.segments()[truth_segment].internodes) {
        const TraceInternode& internode = truth_.internode(number);
        for (const TraceSample& sample : samples_of(truth_, internode, step_along(truth_, internode, slack_))) {
            double nearest = std::numeric_limits<double>::infinity();
            for (const TraceCourse::Near& near : course.near(sample, slack_))
                nearest = std::min(nearest, near.distance);
            if (std::isinf(nearest)) return std::nullopt;
            sum += nearest * nearest;
            ++count;
        }
    }
    return sum / double(count);
}

}  // namespace shvr
