#pragma once
// A trace as two lists, of its segments and of its nodes. The lists are rebuilt only when the trace changes, so the
// cost of scrolling depends only on the visible rows. Pure; main thread only.

#include <string>
#include <vector>

#include "engine/annotation/trace/tracing.h"
#include "engine/workbench/actions/action.h"

namespace shvr::ui {

struct SegmentRow {
    uint32_t internode = 0;        ///< smallest number of the segment's internodes, which identifies the segment
    uint32_t first = 0, last = 0;  ///< nodes at its ends
    size_t nodes = 0;
    uint8_t group = 0;       ///< group of most of its length
    bool is_mixed = false;   ///< its internodes have several groups
    double length = 0.0;     ///< physical units
    glm::dvec3 middle{0.0};  ///< position of the segment's middle node, in volume space
};
struct NodeRow {
    uint32_t node = 0;
    uint8_t group = 0;
    size_t internodes = 0;
    double radius = 0.0;  ///< physical units
};

enum class TraceOrder { number, group, nodes, length };

class TraceList {
public:
    /// Rebuilds the rows if the trace or the order has changed since the last call. Returns whether it rebuilt them.
    bool update(const TraceGraph& trace, TraceOrder order, bool is_descending);
    const std::vector<SegmentRow>& segments() const { return segments_; }
    /// Nodes in the order of their numbers; `order` applies to segments only.
    const std::vector<NodeRow>& nodes() const { return nodes_; }

private:
    void sort();

    uint64_t revision_ = 0;
    TraceOrder order_ = TraceOrder::number;
    bool is_descending_ = false;
    std::vector<SegmentRow> segments_;
    std::vector<NodeRow> nodes_;
};

/// Returns actions that select the segment and point the camera at its middle.
Actions select_segment(const SegmentRow& row);
Action go_to(const SegmentRow& row, const glm::dvec3& spacing);
/// Does the same for a node.
Actions select_node(const NodeRow& row);
Action go_to(const NodeRow& row, const TraceGraph& trace, const glm::dvec3& spacing);
/// Returns whether the row's segment is selected, as a whole or in part.
bool is_selected(const SegmentRow& row, const TraceSelection& selection);

}  // namespace shvr::ui
