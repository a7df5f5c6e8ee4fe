#pragma once
// Highlights in a trace. Pure.

#include <optional>
#include <vector>

#include "engine/annotation/trace/tracing.h"
#include "engine/look/overlay.h"

namespace shvr {

/// The highlighted nodes and internodes: the selection, and the node that a click would select. If a segment has more
/// than MAX_MARKS internodes, only a part of it is marked.
struct TraceMarks {
    std::vector<OverlayScene::Ball> balls;
    std::vector<OverlayScene::Line> lines;
};
inline constexpr size_t MAX_MARKS = 2000;
inline constexpr glm::dvec3 SELECTED_COLOR{1.0, 0.83, 0.02};  ///< yellow, linear light
inline constexpr glm::dvec3 NEARBY_COLOR{0.45, 0.05, 0.9};    ///< purple
inline constexpr glm::dvec3 LINKED_COLOR{0.35, 0.26, 0.0};    ///< a darker yellow
/// `moved_by`: how far the selection has been dragged. `shown_links`: number of internodes nearest to the selected node
/// that are also drawn as lines, because the surfaces hide their centre lines.
TraceMarks trace_marks(const TraceGraph& trace, std::optional<uint32_t> nearby, double min_radius,
                       const std::optional<glm::dvec3>& moved_by = {}, size_t shown_links = 0);

}  // namespace shvr
