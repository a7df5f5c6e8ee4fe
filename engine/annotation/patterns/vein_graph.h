#pragma once
// A trace as arrays, in physical space, with the part of the flower head of each node and internode. Any thread.

#include <span>
#include <vector>

#include "engine/annotation/patterns/sections.h"
#include "engine/annotation/trace/trace_space.h"
#include "engine/annotation/trace/tracing.h"

namespace shvr {

struct VeinNode {
    glm::dvec3 at;
    HeadPart part;  ///< part of its group
};
/// An internode. `part`: the part of its group or, if the group has none, the part of its two nodes if they agree.
struct VeinLink {
    uint32_t a, b;  ///< indices of nodes
    HeadPart part;
    bool is_connection;  ///< its nodes are of two parts
    double length;
    uint32_t other(uint32_t node) const { return node == a ? b : a; }
    /// Whether the internode is a piece of a vein of this part, and not a connection.
    bool is_vein_of(HeadPart of) const { return part == of && !is_connection; }
};

class VeinGraph {
public:
    VeinGraph(const TraceGraph& trace, const HeadSections& sections, const TraceSpace& space);
    const std::vector<VeinNode>& nodes() const { return nodes_; }
    const std::vector<VeinLink>& links() const { return links_; }
    /// Indices of links, ascending.
    std::span<const uint32_t> links_of(size_t node) const
    {
        return std::span(ends_).subspan(first_[node], first_[node + 1] - first_[node]);
    }
    size_t count(HeadPart part) const;

private:
    std::vector<VeinNode> nodes_;
    std::vector<VeinLink> links_;
    std::vector<uint32_t> ends_;
    std::vector<size_t> first_;
};

}  // namespace shvr
