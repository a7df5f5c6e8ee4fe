#pragma once
// Turns an operation of a script or the window into records for the history, or into another selection, which is not a
// step of it. Operations have positions in voxels and radii in voxels along x; records have the volume's unit. Pure;
// any thread.

#include <string>

#include "engine/annotation/trace/trace_op.h"
#include "engine/annotation/trace/tracing.h"

namespace shvr {

/// Defaults for values that an operation does not state.
struct TraceDefaults {
    glm::dvec3 spacing{1.0};     ///< of the volume
    double radius_voxels = 6.0;  ///< the probe's
    uint8_t group = 1;           ///< that the probe paints
};

struct TraceEffect {
    std::string label;                        ///< of the command: "node, group 2"
    std::vector<TraceChange> changes;         ///< empty where nothing would change
    std::optional<TraceSelection> selection;  ///< the new selection
};

/// Fails if the operation cannot be carried out, or its target is farther away than it allows.
TraceEffect effect_of(const TraceOp& op, const TraceGraph& trace, const TraceDefaults& defaults);

}  // namespace shvr
