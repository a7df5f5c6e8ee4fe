#pragma once
// To which of the voxels that a brush selects it gives its group, and the records that do so.
//
// The one place that knows of locks: painting, preview and counts all ask it. A brush's kernels find voxels by density,
// shape and connectivity alone; who may have them is decided where the mask is, on the host. Pure; any thread.

#include <vector>

#include "engine/annotation/brush.h"

namespace shvr {

/// What becomes of a selected voxel.
enum class Fate {
    has_group,  ///< it is in the painted group already
    changes,
    locked,      ///< stays, since the group that it is in is locked
    locked_out,  ///< stays, since the painted group is locked
    painted,     ///< stays, since the brush is held to unpainted voxels
};

struct PaintRule {
    uint8_t group = 1;  ///< 0 erases
    bool only_unpainted = false;
    GroupSet locked{};
    /// Of a selected voxel that is in group `held`, 0 if it is unpainted.
    Fate fate_of(uint8_t held) const;
};
PaintRule rule_of(const PaintOp& op);

/// The records that give `rule.group` to the voxels of `selection` that it changes.
std::vector<MaskBrickChange> paint_changes(const Mask& mask, const VoxelSelection& selection, const PaintRule& rule);

}  // namespace shvr
