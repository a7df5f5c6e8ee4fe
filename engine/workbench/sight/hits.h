#pragma once
// Finds the part of a trace under a pixel. Pure; any thread, while the trace does not change.

#include <bitset>
#include <optional>

#include "engine/annotation/trace/tracing.h"
#include "engine/look/panes.h"
#include "engine/session/session.h"

namespace shvr::ui {

struct TraceHit {
    std::optional<uint32_t> node, internode;  ///< one of them, or none
    double depth = 0.0;                       ///< physical units along the view
    double radius = 0.0;                      ///< radius in physical units
};
/// Returns a node within its ring or within 6 pixels of its centre (of several, the one nearest to the viewer). Without
/// such a node, returns an internode within 4 pixels of its centre line. In a slice, considers only parts that cross
/// its plane or lie within half a voxel of it. Parts in groups that are not `drawn` are not there. Visits the whole
/// trace.
TraceHit trace_hit(const TraceGraph& trace, const Pane& pane, const glm::dvec2& pixel, const VolumeInfo& volume,
                   const std::bitset<256>& drawn);

/// The groups whose nodes and internodes a pane draws. Slices draw them without the surfaces of `view.meshes`. Cutting
/// planes cut no surfaces, so they take nothing away.
std::bitset<256> groups_in_pane(const Session& session, const Pane& pane);

/// Returns the distance by which a point lies behind the plane of a slice.
double behind_plane(const Camera& camera, const glm::dvec3& point);

}  // namespace shvr::ui
