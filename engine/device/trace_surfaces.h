#pragma once
// The surfaces of a trace (balls for nodes, rods for internodes, in the colours of their groups), and which of these
// surfaces a command changes. Pure functions.

#include <optional>
#include <span>
#include <vector>

#include "engine/annotation/trace/tracing.h"
#include "engine/annotation/work/history.h"
#include "engine/look/groups.h"
#include "engine/look/surfaces/surface_tree.h"

namespace shvr {

/// Least radius with which a node is drawn, relative to the thickest internode that meets it, so that nodes are seen
/// along their internodes. Only pictures have it: the trace, its files and its measures keep the true radius.
inline constexpr double NODE_FACTOR = 1.8;

/// Omits hidden groups. `spacing`: the volume's. Nodes without a radius are drawn with a radius of half a voxel along
/// the finest axis.
std::vector<KeyedSurface> surfaces_of(const TraceGraph& trace, const Groups& groups, const glm::dvec3& spacing);

/// The keys of all surfaces that changes affect, and those of the affected surfaces that still exist.
struct ChangedSurfaces {
    std::vector<uint64_t> keys;
    std::vector<KeyedSurface> now;
};
/// `trace` already contains `changes`. Returns null if the changes may affect the whole trace, because a group's radius
/// has changed.
std::optional<ChangedSurfaces> changed_surfaces(const TraceGraph& trace, const Groups& groups,
                                                const glm::dvec3& spacing, std::span<const Change> changes);

/// The box that may look different after `changes`, which `trace` already contains; empty if no change concerns a
/// trace.
VoxelBox trace_reach(const TraceGraph& trace, std::span<const Change> changes, const glm::dvec3& spacing);

}  // namespace shvr
