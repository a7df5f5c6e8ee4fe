#include "engine/workbench/lists/trace_list.h"

#include <algorithm>
#include <map>

#include "engine/annotation/trace/trace_segments.h"

namespace shvr::ui {

namespace {

SegmentRow row_of(const TraceGraph& trace, const TraceSegment& segment)
{
    SegmentRow row{.internode = *std::ranges::min_element(segment.internodes),
                   .first = segment.nodes.front(),
                   .last = segment.nodes.back(),
                   .nodes = segment.nodes.size() - (segment.is_loop() ? 1 : 0),
                   .middle = trace.node(segment.nodes[segment.nodes.size() / 2]).position};
    std::map<uint8_t, double> length_by_group;
    for (const uint32_t number : segment.internodes) {
        const TraceInternode& internode = trace.internode(number);
        const double length = trace.length_of(internode);
        row.length += length;
        length_by_group[internode.group] += length;
    }
    row.is_mixed = length_by_group.size() > 1;
    row.group = std::ranges::max_element(length_by_group, {}, &std::pair<const uint8_t, double>::second)->first;
    return row;
}

}  // namespace

bool TraceList::update(const TraceGraph& trace, TraceOrder order, bool is_descending)
{
    const bool is_same = revision_ == trace.revision();
    if (is_same && order == order_ && is_descending == is_descending_) return false;
    order_ = order;
    is_descending_ = is_descending;
    if (!is_same) {
        revision_ = trace.revision();
        segments_.clear();
        nodes_.clear();
        for (const TraceSegment& segment : segments_of(trace)) segments_.push_back(row_of(trace, segment));
        for (const auto& [number, node] : trace.nodes())
            nodes_.push_back({number, node.group, trace.internodes_of(number).size(), node.radius});
    }
    sort();
    return true;
}

/// Equal ones by number.
void TraceList::sort()
{
    const auto is_before = [this](const SegmentRow& a, const SegmentRow& b) {
        switch (order_) {
            case TraceOrder::number: break;
            case TraceOrder::group:
                if (a.group != b.group) return a.group < b.group;
                break;
            case TraceOrder::nodes:
                if (a.nodes != b.nodes) return a.nodes < b.nodes;
                break;
            case TraceOrder::length:
                if (a.length != b.length) return a.length < b.length;
                break;
        }
        return a.internode < b.internode;
    };
    std::ranges::sort(segments_, [&](const SegmentRow& a, const SegmentRow& b) {
        return is_descending_ ? is_before(b, a) : is_before(a, b);
    });
}

Actions select_segment(const SegmentRow& row)
{
    SelectOp op;
    op.number = row.internode;
    op.is_internode = true;
    return {op, SelectSegmentOp{}};
}

Action go_to(const SegmentRow& row, const glm::dvec3& spacing)
{
    return GoTo{row.middle / spacing};
}

Actions select_node(const NodeRow& row)
{
    SelectOp op;
    op.number = row.node;
    return {op};
}

Action go_to(const NodeRow& row, const TraceGraph& trace, const glm::dvec3& spacing)
{
    return GoTo{trace.node(row.node).position / spacing};
}

bool is_selected(const SegmentRow& row, const TraceSelection& selection)
{
    return std::ranges::binary_search(selection.internodes, row.internode);
}

}  // namespace shvr::ui
