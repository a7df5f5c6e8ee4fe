#pragma once
// Converts an operation of a script or the window into records for the history, or into a new selection, which is not a
// step of the history. Operations use positions in voxels and radii in voxels along x; records use the volume's unit.
// Pure; any thread.

#include <bitset>
#include <string>

#include "engine/annotation/trace/trace_edit.h"
#include "engine/annotation/trace/trace_op.h"
#include "engine/annotation/trace/tracing.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Default values for parameters that an operation does not state.
struct TraceDefaults {
    glm::dvec3 spacing{1.0};               ///< the volume's
    double radius_voxels = 6.0;            ///< the probe's
    uint8_t group = 1;                     ///< the group that the probe paints
    Size3 size{0};                         ///< the volume's size in voxels; 0: unknown, so nodes may be anywhere
    std::bitset<256> found = EVERY_GROUP;  ///< groups whose nodes and internodes can be found by position
};

struct TraceEffect {
    std::string label;                        ///< label of the command: "added a node in group 2"
    std::vector<TraceChange> changes;         ///< empty if nothing would change
    std::optional<TraceSelection> selection;  ///< the new selection
};

/// Fails if the operation is impossible, if the nearest target is further than the operation's search distance, or if a
/// node would lie outside the volume by more than its radius plus the longest side of a voxel.
TraceEffect effect_of(const TraceOp& op, const TraceGraph& trace, const TraceDefaults& defaults);

}  // namespace shvr
