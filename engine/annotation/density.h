#pragma once
// Density painting: offsets that raise (or lower) the intensities of single voxels, stored separately from the volume
// in sparse bricks (sparse_bricks.h).
//
// P is the painted offset; p(v), the offset painted at voxel v, falls off from P to 0 (density_brush.h):
//
//     new = max(p, min(old, P))        P >= 0
//     new = min(p, max(old, P))        P <  0, the same with opposite signs
//
// For P >= 0, an offset above P is lowered to P, and an offset below p(v) is raised to p(v). Painting a second time
// changes nothing more, and the order of positions within a stroke does not matter. P = 0 removes offsets.
//
// Offsets have 32 bits (engine/volume/offset_brick.h).

#include "engine/annotation/sparse_bricks.h"
#include "engine/volume/offset_brick.h"

namespace shvr {

/// A run of voxels whose offsets (as bits, offset_brick.h) change, and all such runs in one brick.
using DensityRun = BrickRun<uint32_t>;
using DensityBrickChange = BrickChange<uint32_t>;

class DensityField : public SparseBricks<uint32_t> {
public:
    /// The field of a volume without voxels.
    DensityField() = default;
    DensityField(const Size3& size, VoxelType type) : SparseBricks(size), type_(type) {}

    VoxelType type() const { return type_; }
    /// In intensity units.
    double at(const Size3& voxel) const { return offset_of(type_, value_at(voxel)); }
    /// Number of voxels that have an offset.
    int64_t voxels() const { return voxels_; }

    /// Returns why a record cannot be applied; empty if it can. Offsets must be finite and not exceed offset_limit.
    std::string why_it_does_not_fit(const DensityBrickChange& change, Direction direction) const;
    /// Applies a record that fits (SHVR_CHECK).
    void apply(const DensityBrickChange& change, Direction direction);
    /// For file readers: sets the offsets of a brick without offsets (SHVR_CHECK); drops offsets outside the volume.
    void put(int64_t index, const OffsetBrick& offsets) { voxels_ += SparseBricks::put(index, offsets); }

private:
    VoxelType type_ = VoxelType::uint8;
    int64_t voxels_ = 0;
};

}  // namespace shvr
