#pragma once
// What a trace looks like: balls for nodes, rods for internodes, in the colours of their groups; and what of it a
// command changes. Pure.

#include <optional>
#include <span>
#include <vector>

#include "engine/annotation/trace/tracing.h"
#include "engine/annotation/work/history.h"
#include "engine/look/groups.h"
#include "engine/look/surface_tree.h"

namespace shvr {

/// Hidden groups are left out. `spacing`: of the volume; what has no radius is drawn with half a voxel's, along the
/// finest axis.
std::vector<KeyedSurface> surfaces_of(const TraceGraph& trace, const Groups& groups, const glm::dvec3& spacing);

/// The surfaces that changes are about, and those of them that there are now.
struct ChangedSurfaces {
    std::vector<uint64_t> keys;
    std::vector<KeyedSurface> now;
};
/// Of changes of which the trace holds the result. Null where they may be about all of it: a group's radius has
/// changed.
std::optional<ChangedSurfaces> changed_surfaces(const TraceGraph& trace, const Groups& groups,
                                                const glm::dvec3& spacing, std::span<const Change> changes);

/// What may look different after these changes, of which the trace holds the result; empty where none is of a trace.
VoxelBox trace_reach(const TraceGraph& trace, std::span<const Change> changes, const glm::dvec3& spacing);

}  // namespace shvr
