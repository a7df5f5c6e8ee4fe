#pragma once
// What a trace looks like: balls for nodes, rods for internodes, in the colours of their groups. One thread, the renderer's.

#include <vector>

#include "engine/annotation/trace/tracing.h"
#include "engine/annotation/work/history.h"
#include "engine/look/groups.h"
#include "engine/look/overlay.h"
#include "engine/picture/renderer.h"

namespace shvr {

/// Hidden groups are left out. `spacing`: of the volume; what has no radius is drawn with half a voxel's, along the finest
/// axis.
std::vector<KeyedSurface> surfaces_of(const TraceGraph& trace, const Groups& groups, const glm::dvec3& spacing);

/// Pictures show these surfaces and those of the trace, from now on.
void show_surfaces(Renderer& renderer, const std::vector<SurfaceLook>& surfaces, const TraceGraph& trace,
                   const Groups& groups);
/// The same after these changes, of which the trace holds the result. What it costs follows the changes, but for those of
/// thousands of nodes, and of a group's size.
void show_changed_surfaces(Renderer& renderer, const std::vector<SurfaceLook>& surfaces, const TraceGraph& trace,
                           const Groups& groups, std::span<const Change> changes);

/// What may look different after these changes, of which the trace holds the result; empty where none is of a trace.
VoxelBox trace_reach(const TraceGraph& trace, std::span<const Change> changes, const glm::dvec3& spacing);

/// The nodes and internodes that stand out: what is selected, and the node that a person would take. Segments of more than
/// MOST_MARKS internodes are marked in part.
struct TraceMarks {
    std::vector<OverlayScene::Ball> balls;
    std::vector<OverlayScene::Line> lines;
};
inline constexpr size_t MOST_MARKS = 2000;
inline constexpr glm::dvec3 SELECTED_COLOR{1.0, 0.83, 0.02};  ///< yellow, linear light
inline constexpr glm::dvec3 NEARBY_COLOR{0.45, 0.05, 0.9};    ///< purple
/// `moved_to`: where the selected node is being dragged.
TraceMarks trace_marks(const TraceGraph& trace, std::optional<uint32_t> nearby, double least_radius,
                       const std::optional<glm::dvec3>& moved_to = {});

}  // namespace shvr
