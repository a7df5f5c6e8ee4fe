#pragma once
// Segments of a trace: chains of internodes between two nodes that are branches (three or more internodes) or ends
// (one internode), and loops without such nodes. Every internode is in exactly one segment. Any thread may call
// these.

#include <bitset>
#include <set>
#include <vector>

#include "engine/annotation/trace/tracing.h"

namespace shvr {

struct TraceSegment {
    std::vector<uint32_t> nodes;       ///< in order, one more than internodes; a loop ends with its first node
    std::vector<uint32_t> internodes;  ///< in that order
    bool is_loop() const { return nodes.front() == nodes.back(); }
};

/// The segment that contains an internode. Segments also end at the nodes `stops`.
TraceSegment segment_through(const TraceGraph& trace, uint32_t internode, const std::set<uint32_t>& stops = {});
/// All segments, sorted by their smallest internode number. Nodes without internodes belong to no segment.
std::vector<TraceSegment> segments_of(const TraceGraph& trace, const std::set<uint32_t>& stops = {});

/// The objects that an edit of the segment changes: its internodes, and its nodes except branches, which are shared.
TraceSelection selection_of(const TraceGraph& trace, const TraceSegment& segment);

/// The fraction along an internode of its position nearest to a point: 0 at the first node, 1 at the second.
double share_along(const TraceGraph& trace, const TraceInternode& internode, const glm::dvec3& position);

struct PlaceOnTrace {
    uint32_t internode = 0;
    double share = 0.0;        ///< fraction along it
    glm::dvec3 position{0.0};  ///< volume space
};
/// The position nearest to a point, within `reach`, on any internode of `groups`, except the internodes of the node
/// `except_of`. In a tie, the internode with the smallest number wins. Checks only the internodes of nodes within
/// `reach` plus half the longest internode, since no others can be within reach.
std::optional<PlaceOnTrace> nearest_place(const TraceGraph& trace, const glm::dvec3& position, double reach,
                                          std::optional<uint32_t> except_of = {},
                                          const std::bitset<256>& groups = std::bitset<256>().set());

/// The distance of a point from an internode.
double distance_to(const TraceGraph& trace, const TraceInternode& internode, const glm::dvec3& position);

}  // namespace shvr
