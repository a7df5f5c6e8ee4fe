#pragma once
// Traces for tests.

#include <vector>

#include "engine/annotation/trace/trace_forms.h"

namespace shvr::test {

/// Nodes are numbered from 0, in order.
inline TraceGraph trace_of(const std::vector<TraceNode>& nodes, const std::vector<TraceInternode>& internodes)
{
    TraceReader reader("test");
    for (const TraceNode& node : nodes) reader.add_node("test", node);
    for (const TraceInternode& internode : internodes) reader.add_internode("test", internode);
    return std::move(reader.trace);
}

/// A trace that grows by nodes and links, all in group 1.
class GrowingTrace {
public:
    uint32_t node(const glm::dvec3& at, double radius)
    {
        const auto number = uint32_t(trace.next_node());
        trace.apply(TraceNodeChange{number, {}, TraceNode{at, radius, 1}}, Direction::forwards);
        return number;
    }
    void link(uint32_t a, uint32_t b)
    {
        trace.apply(TraceInternodeChange{uint32_t(trace.next_internode()), {}, TraceInternode{a, b, 1}},
                    Direction::forwards);
    }

    TraceGraph trace;
};

}  // namespace shvr::test
