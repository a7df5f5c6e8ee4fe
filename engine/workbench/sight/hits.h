#pragma once
// Which part of a trace is under a pixel. Pure; any thread, while the trace is lent.

#include <optional>

#include "engine/annotation/trace/tracing.h"
#include "engine/look/panes.h"

namespace shvr::ui {

struct TraceHit {
    std::optional<uint32_t> node, internode;  ///< one of them, or none
    double depth = 0.0;                       ///< physical units along the view
    double radius = 0.0;                      ///< likewise
};
/// A node within its ring, or within 6 pixels of its middle; of several, the one nearest to the viewer; or else an
/// internode within 4 pixels of its middle line. In a slice only what the plane passes through or within half a voxel
/// of. Visits the whole trace.
TraceHit trace_hit(const TraceGraph& trace, const Pane& pane, const glm::dvec2& pixel, const VolumeInfo& volume);

/// Of a slice: how far a point lies behind its plane.
double behind_plane(const Camera& camera, const glm::dvec3& point);

}  // namespace shvr::ui
