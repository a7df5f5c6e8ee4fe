#pragma once
// The segmentation mask: one 8-bit colour group per voxel (0 = unpainted), kept in sparse bricks of 32^3 voxels. A brick
// that is wholly 0 does not exist, so an unpainted volume costs nothing. The mask is changed through records of exact
// before and after values and through nothing else; undo is the same record the other way round.
//
// Bricks never change once they are there, so a copy of a mask costs its table and shares them. One thread owns a mask (the
// main one) and lends it as const; a copy may go to another thread.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/annotation/direction.h"
#include "engine/volume/volume.h"
#include "shaders/bricks.h"

namespace shvr {

inline constexpr size_t MASK_BRICK_VOXELS = size_t(gpu::BRICK_SIZE) * gpu::BRICK_SIZE * gpu::BRICK_SIZE;
using MaskBrick = std::array<uint8_t, MASK_BRICK_VOXELS>;  ///< x fastest

/// Consecutive voxels of one brick (x fastest) that go from one group to another; `before != after`.
struct MaskRun {
    uint16_t first = 0;
    uint16_t last = 0;  ///< inclusive
    uint8_t before = 0;
    uint8_t after = 0;
    bool operator==(const MaskRun&) const = default;
};

/// What changed in one brick. Runs ascend and do not overlap.
struct MaskBrickChange {
    int64_t brick = 0;  ///< linear index in the grid of bricks, x fastest
    std::vector<MaskRun> runs;
    bool operator==(const MaskBrickChange&) const = default;
    int64_t voxels() const;
};

/// Appends a row of groups that begins at voxel `first` of an unpainted brick. Joins the last run where it can.
void append_painted_runs(std::vector<MaskRun>& runs, std::span<const uint8_t> row, size_t first);

class Mask {
public:
    explicit Mask(Size3 size);

    Size3 size() const { return size_; }
    glm::i64vec3 brick_counts() const { return counts_; }

    uint8_t at(const Size3& voxel) const;
    /// Null where no voxel of the brick is painted.
    const MaskBrick* brick(int64_t index) const;
    /// Bricks with painted voxels, ascending.
    std::vector<int64_t> painted_bricks() const;
    /// Voxels by group; [0] counts the unpainted ones.
    std::array<int64_t, 256> voxels_by_group() const;

    /// Why a record cannot be applied: runs must ascend inside the volume, over voxels that hold what the record says they
    /// hold before the change. Empty where it fits.
    std::string misfit(const MaskBrickChange& change, Direction direction) const;
    /// Applies a record that fits (SHVR_CHECK). Frees bricks that return to wholly 0.
    void apply(const MaskBrickChange& change, Direction direction);

private:
    Size3 size_;
    glm::i64vec3 counts_;
    std::map<int64_t, std::shared_ptr<const MaskBrick>> bricks_;
    std::array<int64_t, 256> voxels_by_group_{};
};

}  // namespace shvr
