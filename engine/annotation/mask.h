#pragma once
// The segmentation mask: one 8-bit colour group per voxel (0 = unpainted), in sparse bricks (sparse_bricks.h), so that
// an unpainted volume costs nothing.

#include "engine/annotation/sparse_bricks.h"

namespace shvr {

using MaskBrick = SparseBricks<uint8_t>::Brick;
/// A run of voxels that change from one group to another, and all such runs in one brick.
using MaskRun = BrickRun<uint8_t>;
using MaskBrickChange = BrickChange<uint8_t>;

class Mask : public SparseBricks<uint8_t> {
public:
    explicit Mask(const Size3& size);

    uint8_t at(const Size3& voxel) const { return value_at(voxel); }
    /// Number of voxels in each group; [0] counts unpainted voxels.
    const std::array<int64_t, 256>& voxels_by_group() const { return voxels_by_group_; }

    /// Returns why a record cannot be applied; empty if it can be applied.
    std::string why_it_does_not_fit(const MaskBrickChange& change, Direction direction) const;
    /// Applies a record that fits (SHVR_CHECK).
    void apply(const MaskBrickChange& change, Direction direction);

private:
    std::array<int64_t, 256> voxels_by_group_{};
};

}  // namespace shvr
