#pragma once
// Density painting: offsets that raise (or lower) what single voxels hold, in sparse bricks of 32^3, beside the volume.
// Like the mask it changes through records of exact before and after and through nothing else.
//
// With P the offset that is painted and p(v) that of voxel v, which falls off from P to 0 (density_brush.h):
//
//     new = max(p, min(old, P))        P >= 0
//     new = min(p, max(old, P))        P <  0, the same with signs turned
//
// so that painting over higher offsets lowers them to P, painting over lower ones keeps the higher of both, painting the
// same again changes nothing, and the order of positions within a stroke does not matter. P = 0 resets.
//
// Offsets are kept to 32 bits (engine/volume/offset_brick.h). A brick without offsets does not exist. One thread owns a
// field; bricks never change once they are there, so other threads may keep those they were given.

#include <map>
#include <memory>

#include "engine/annotation/mask.h"
#include "engine/volume/offset_brick.h"

namespace shvr {

/// Consecutive voxels of one brick (x fastest) that go from one offset to another; `before != after`.
struct DensityRun {
    uint16_t first = 0;
    uint16_t last = 0;  ///< inclusive
    uint32_t before = 0;
    uint32_t after = 0;
    bool operator==(const DensityRun&) const = default;
};

/// What changed in one brick. Runs ascend and do not overlap.
struct DensityBrickChange {
    int64_t brick = 0;  ///< linear index in the grid of bricks, x fastest
    std::vector<DensityRun> runs;
    bool operator==(const DensityBrickChange&) const = default;
    int64_t voxels() const;
};

class DensityField {
public:
    /// Of a volume without voxels.
    DensityField() = default;
    DensityField(Size3 size, VoxelType type);

    Size3 size() const { return size_; }
    VoxelType type() const { return type_; }
    glm::i64vec3 brick_counts() const { return counts_; }
    glm::ivec3 position_of(int64_t brick) const;

    /// In intensity units.
    double at(const Size3& voxel) const;
    /// Null where no voxel of the brick has an offset.
    std::shared_ptr<const OffsetBrick> brick(int64_t index) const;
    /// Bricks with offsets, ascending.
    std::vector<int64_t> painted_bricks() const;
    /// How many voxels have one.
    int64_t voxels() const { return voxels_; }

    /// Why a record cannot be applied, as Mask::misfit says; nor can offsets that are no numbers, or beyond the limit.
    std::string misfit(const DensityBrickChange& change, Direction direction) const;
    /// Applies a record that fits (SHVR_CHECK). Frees bricks that return to wholly 0.
    void apply(const DensityBrickChange& change, Direction direction);
    /// Replaces a brick that has no offsets; those beyond the volume's end are dropped. For files.
    void put(int64_t index, OffsetBrick offsets);
    /// The voxels that a record is about lie in this box of the volume.
    VoxelBox reach_of(const DensityBrickChange& change) const;

private:
    Size3 extent_of(int64_t brick) const;
    Size3 size_{0};
    VoxelType type_ = VoxelType::uint8;
    glm::i64vec3 counts_{0};
    std::map<int64_t, std::shared_ptr<const OffsetBrick>> bricks_;
    int64_t voxels_ = 0;
};

}  // namespace shvr
