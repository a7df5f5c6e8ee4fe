#pragma once
// Describes how a stroke affected the groups, in numbers and in a sentence. Main thread.

#include <functional>
#include <map>
#include <span>
#include <string>

#include "engine/annotation/painting.h"

namespace shvr {

struct StrokeResult {
    PaintOp stroke;                              ///< without its path
    int64_t regrouped = 0;                       ///< voxels that changed their group
    int64_t raised = 0;                          ///< voxels that changed their offset
    using ByGroup = std::map<uint8_t, int64_t>;  ///< number of voxels per group; omits groups without voxels
    ByGroup taken_from{};                        ///< voxels of `regrouped` by the group that lost them
    ByGroup kept_locked{};                       ///< selected, but in a locked group
    int64_t kept_locked_out = 0;                 ///< selected, but unchanged because the painted group is locked
    int64_t kept_painted = 0;  ///< selected, but already painted, and the brush is limited to unpainted voxels

    /// Number of voxels that changed their group, plus number of voxels that changed their offset.
    int64_t voxels() const { return regrouped + raised; }
    /// Number of selected voxels that did not change because of locks.
    int64_t kept_by_locks() const;
    bool operator==(const StrokeResult&) const = default;
};

/// Counts the effects of a stroke, whose selected voxels come from the device in one or more answers. A voxel that
/// several answers select counts once.
class StrokeTally {
public:
    explicit StrokeTally(const PaintOp& stroke);
    /// Adds an answer of the device: the selected voxels, the mask before the answer, and the resulting records.
    void add(const Mask& before, const VoxelSelection& selection, std::span<const MaskBrickChange> groups,
             std::span<const DensityBrickChange> offsets);
    const StrokeResult& result() const { return result_; }

private:
    void add_kept(const Mask& before, const VoxelSelection& selection);

    PaintRule rule_;
    StrokeResult result_;
    /// Voxels that were counted already. Regrouped voxels need no such set: a stroke changes a voxel's group only once.
    std::map<int64_t, VoxelSelection::Bits> kept_, raised_;
};

/// Display name of a group; empty, or "group N", if it has none.
using GroupNames = std::function<std::string(uint8_t)>;
/// "Painted 20 voxels in group 3 (leaf trace); 12 of them were group 1 (aorta)". If nothing changed, says why.
std::string sentence_of(const StrokeResult& result, const GroupNames& name_of);

}  // namespace shvr
