#pragma once
// Finds which part of a trace is under a pixel. Pure; any thread, while the trace does not change.

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
/// For a click that can mean nothing else: the distance, in pixels, from the rim of the nearest node or internode.
inline constexpr double SPARE_PIXELS = 10.0;

/// Returns a node within its ring or within 6 pixels of its centre (of several, the one nearest to the viewer). If
/// there is none, returns an internode within 4 pixels of its centre line; and if there is none, the node or internode
/// that is nearest in pixels, at most `spare` farther away. In a slice, considers only parts that cross
/// its plane or lie within half a voxel of it. Ignores parts in groups that are not in `drawn`. Takes time linear in
/// the trace's size.
TraceHit trace_hit(const TraceGraph& trace, const Pane& pane, const glm::dvec2& pixel, const VolumeInfo& volume,
                   const std::bitset<256>& drawn, double spare = 0.0);

/// Returns the groups whose nodes and internodes a pane draws. Slices draw them even if `view.meshes` is off. Cutting
/// planes do not cut the trace, so they hide no group.
std::bitset<256> groups_in_pane(const Session& session, const Pane& pane);

/// Returns how far a point lies behind the plane of a slice, in physical units.
double behind_plane(const Camera& camera, const glm::dvec3& point);

}  // namespace shvr::ui
