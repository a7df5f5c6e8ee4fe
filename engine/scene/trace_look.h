#pragma once
// What a trace looks like: balls for nodes, rods for internodes, in the colours of their groups. One thread, the renderer's.

#include <vector>

#include "engine/annotation/tracing.h"
#include "engine/scene/groups.h"
#include "engine/scene/renderer.h"

namespace shvr {

/// Hidden groups are left out. `spacing`: of the volume; what has no radius is drawn with half a voxel's, along the finest
/// axis.
std::vector<SurfaceLook> surfaces_of(const TraceGraph& trace, const Groups& groups, const glm::dvec3& spacing);

/// Pictures show these surfaces and those of the trace, from now on.
void show_surfaces(Renderer& renderer, std::vector<SurfaceLook> surfaces, const TraceGraph& trace,
                   const Groups& groups);

}  // namespace shvr
