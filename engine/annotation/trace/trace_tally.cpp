#include "engine/annotation/trace/trace_tally.h"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>

#include "engine/annotation/trace/tracing.h"

namespace shvr {

namespace {

bool is_inner(const TraceGraph& trace, uint32_t node)
{
    return trace.internodes_of(node).size() == 2;
}

/// Walks along a segment, starting at an inner node via one of its two internodes.
class Walker {
public:
    Walker(const TraceGraph& trace, uint32_t node, uint32_t internode)
        : trace_(trace), node_(node), internode_(internode)
    {}
    /// Advances to the next node; `is_at_end` then tells whether this is the segment's last node.
    void step()
    {
        node_ = trace_.internode(internode_).other(node_);
        if (!is_inner(trace_, node_)) return;
        const std::span<const uint32_t> links = trace_.internodes_of(node_);
        internode_ = links[0] == internode_ ? links[1] : links[0];
    }
    uint32_t node() const { return node_; }
    bool is_at_end() const { return !is_inner(trace_, node_); }

private:
    const TraceGraph& trace_;
    uint32_t node_, internode_;
};

struct Closed {
    bool is_closed = false;  ///< the node lies on a loop that consists of inner nodes only
    bool has_other = false;  ///< `other` lies on the same loop
};

/// Walks in both directions alternately, so the cost depends on the distance to the nearer end of the segment.
Closed closed_segment_at(const TraceGraph& trace, uint32_t node, uint32_t other)
{
    if (!is_inner(trace, node)) return {};
    const std::span<const uint32_t> links = trace.internodes_of(node);
    std::array<Walker, 2> walkers{Walker(trace, node, links[0]), Walker(trace, node, links[1])};
    bool has_other = node == other;
    for (;;)
        for (size_t i = 0; i < 2; ++i) {
            walkers[i].step();
            if (walkers[i].is_at_end()) return {};
            has_other = has_other || walkers[i].node() == other;
            if (walkers[0].node() == walkers[1].node()) return {true, has_other};
        }
}

size_t closed_segments_at(const TraceGraph& trace, const TraceInternode& internode)
{
    const Closed a = closed_segment_at(trace, internode.a, internode.b);
    if (a.has_other) return 1;
    return size_t{a.is_closed} + size_t{closed_segment_at(trace, internode.b, internode.a).is_closed};
}

size_t inner_nodes_of(const TraceGraph& trace, const TraceInternode& internode)
{
    return size_t{is_inner(trace, internode.a)} + size_t{is_inner(trace, internode.b)};
}

/// The binary exponent of a length; for 0, that of the smallest normal double.
int exponent_of(double length)
{
    return std::ilogb(std::max(length, DBL_MIN));
}

}  // namespace

void TraceTally::LongSum::add(double value)
{
    // Knuth's TwoSum: `low` collects the rounding errors of `high`.
    const double sum = high + value, part = sum - high;
    low += (high - (sum - part)) + (value - part);
    high = sum;
}

void TraceTally::add_length(const TraceGraph& trace, const TraceInternode& internode)
{
    const double length = trace.length_of(internode);
    Group& group = groups_[internode.group];
    ++group.internodes;
    group.length.add(length);
    ++lengths_[exponent_of(length)];
}

void TraceTally::remove_length(const TraceGraph& trace, const TraceInternode& internode)
{
    const double length = trace.length_of(internode);
    const auto group = groups_.find(internode.group);
    group->second.length.add(-length);
    if (--group->second.internodes == 0) groups_.erase(group);
    const auto alike = lengths_.find(exponent_of(length));
    if (--alike->second == 0) lengths_.erase(alike);
}

double TraceTally::longest_at_most() const
{
    return lengths_.empty() ? 0.0 : std::ldexp(1.0, lengths_.rbegin()->first + 1);
}

void TraceTally::before_move(const TraceGraph& trace, uint32_t node)
{
    for (const uint32_t number : trace.internodes_of(node)) remove_length(trace, trace.internode(number));
}

void TraceTally::after_move(const TraceGraph& trace, uint32_t node)
{
    for (const uint32_t number : trace.internodes_of(node)) add_length(trace, trace.internode(number));
}

void TraceTally::before_link(const TraceGraph& trace, const TraceInternode& internode, bool is_there)
{
    if (is_there) remove_length(trace, internode);
    inner_nodes_ -= inner_nodes_of(trace, internode);
    closed_segments_ -= closed_segments_at(trace, internode);
}

void TraceTally::after_link(const TraceGraph& trace, const TraceInternode& internode, bool is_there)
{
    if (is_there) add_length(trace, internode);
    inner_nodes_ += inner_nodes_of(trace, internode);
    closed_segments_ += closed_segments_at(trace, internode);
}

void TraceTally::change_group(const TraceGraph& trace, const TraceInternode& from, const TraceInternode& to)
{
    remove_length(trace, from);
    add_length(trace, to);
}

TraceSummary TraceTally::summary_of(const TraceGraph& trace) const
{
    TraceSummary summary{.nodes = trace.nodes().size(), .internodes = trace.internodes().size()};
    // A segment has one more internode than inner nodes; in a closed segment, the two numbers are equal.
    summary.segments = summary.internodes - inner_nodes_ + closed_segments_;
    LongSum length;
    for (const auto& [number, group] : groups_) {
        summary.group_length[number] = group.length.value();
        length.add(group.length.high);
        length.add(group.length.low);
    }
    summary.length = length.value();
    return summary;
}

}  // namespace shvr
