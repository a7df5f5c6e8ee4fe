#pragma once
// What a stroke did to a person's groups, in numbers and in a sentence. Main thread.

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
    using ByGroup = std::map<uint8_t, int64_t>;  ///< voxels by group from 1 on, none of them 0
    ByGroup taken_from{};                        ///< those of `regrouped` that another group had
    ByGroup kept_locked{};                       ///< selected, but in a locked group
    int64_t kept_locked_out = 0;                 ///< selected, but the painted group is locked
    int64_t kept_painted = 0;  ///< selected, but painted already, and the brush is held to unpainted voxels

    /// Voxels that changed their group plus those that changed their offset.
    int64_t voxels() const { return regrouped + raised; }
    /// All that locks kept from changing.
    int64_t kept_by_locks() const;
    bool operator==(const StrokeResult&) const = default;
};

/// Counts what a stroke does, over one answer of the device or many. A voxel that several answers select counts once.
class StrokeTally {
public:
    explicit StrokeTally(const PaintOp& stroke);
    /// Adds an answer: the selected voxels, the mask before it, and the records that were made of both.
    void add(const Mask& before, const VoxelSelection& selection, std::span<const MaskBrickChange> groups,
             std::span<const DensityBrickChange> offsets);
    const StrokeResult& result() const { return result_; }

private:
    void add_kept(const Mask& before, const VoxelSelection& selection);

    PaintRule rule_;
    StrokeResult result_;
    /// What is counted already. A voxel changes its group once in a stroke, and needs no such mark.
    std::map<int64_t, VoxelSelection::Bits> kept_, raised_;
};

/// Name of a group, for people; empty, or "group N": it has none.
using GroupNames = std::function<std::string(uint8_t)>;
/// "Painted 20 voxels in group 3 (leaf trace); 12 of them were group 1 (aorta)". Where nothing changed it says why.
std::string sentence_of(const StrokeResult& result, const GroupNames& name_of);

}  // namespace shvr
