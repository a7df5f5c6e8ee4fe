#pragma once
// The surfaces of a trace: balls for nodes, rods for internodes, in the colours of their groups; and which of these a
// command changes. Pure.

#include <optional>
#include <span>
#include <vector>

#include "engine/annotation/trace/tracing.h"
#include "engine/annotation/work/history.h"
#include "engine/look/groups.h"
#include "engine/look/surface_tree.h"

namespace shvr {

/// Omits hidden groups. `spacing`: the volume's. Nodes without a radius are drawn with half a voxel's, along the finest
/// axis.
std::vector<KeyedSurface> surfaces_of(const TraceGraph& trace, const Groups& groups, const glm::dvec3& spacing);

/// The keys of the surfaces that changes affect, and those of these surfaces that exist now.
struct ChangedSurfaces {
    std::vector<uint64_t> keys;
    std::vector<KeyedSurface> now;
};
/// For changes that the trace already contains. Null if they may affect the whole trace, because a group's radius has
/// changed.
std::optional<ChangedSurfaces> changed_surfaces(const TraceGraph& trace, const Groups& groups,
                                                const glm::dvec3& spacing, std::span<const Change> changes);

/// The box that may look different after these changes, which the trace already contains; empty if none concerns a
/// trace.
VoxelBox trace_reach(const TraceGraph& trace, std::span<const Change> changes, const glm::dvec3& spacing);

}  // namespace shvr
