#pragma once
// Decides which of a brush's selected voxels change their group, and makes the records of these changes.
//
// Only this code applies locks; painting, preview and counts all use it. A brush's kernels select voxels by density,
// shape and connectivity alone; locks are checked on the host, where the current mask is. Pure; any thread.

#include <vector>

#include "engine/annotation/brush.h"

namespace shvr {

/// The effect of painting on a selected voxel.
enum class Fate {
    has_group,  ///< already in the painted group
    changes,
    locked,      ///< unchanged, because its present group is locked
    locked_out,  ///< unchanged, because the painted group is locked
    painted,     ///< unchanged, because the brush is limited to unpainted voxels
};

struct PaintRule {
    uint8_t group = 1;  ///< 0 erases
    bool only_unpainted = false;
    GroupSet locked{};
    /// The fate of a selected voxel whose present group is `held` (0: unpainted).
    Fate fate_of(uint8_t held) const;
};
PaintRule rule_of(const PaintOp& op);

/// Returns the records that set the group of the selected voxels to `rule.group`, where the rule allows it.
std::vector<MaskBrickChange> paint_changes(const Mask& mask, const VoxelSelection& selection, const PaintRule& rule);

}  // namespace shvr
