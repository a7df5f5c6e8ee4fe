#pragma once
// What an operation of a script or of the window does to a trace: records for the history, or another selection, which is
// no step of it. Positions of operations are voxels and radii voxels along x; here they become the volume's unit. Pure;
// any thread.

#include <string>

#include "engine/annotation/trace/trace_op.h"
#include "engine/annotation/trace/tracing.h"

namespace shvr {

/// What operations leave open.
struct TraceDefaults {
    glm::dvec3 spacing{1.0};     ///< of the volume
    double radius_voxels = 6.0;  ///< the probe's
    uint8_t group = 1;           ///< that it paints
};

struct TraceEffect {
    std::string label;                        ///< of the command: "node, group 2"
    std::vector<TraceChange> changes;         ///< empty where all is that way already
    std::optional<TraceSelection> selection;  ///< what is to be selected instead
};

/// What cannot be done fails with a sentence, and so does what is farther away than the operation allows.
TraceEffect effect_of(const TraceOp& op, const TraceGraph& trace, const TraceDefaults& defaults);

}  // namespace shvr
