#pragma once
// The voxels within a short distance of a set, by words of bits (van den Boomgaard and van Balen 1992): a ball is a set
// of rows along x (ball_rows.h). For each length of a row, all rows of the set are spread by half of it, 64 voxels in
// an operation; each row of the ball then adds the spread rows at its offset, 32 voxels in an operation.
//
// So a brick costs the ball's cross-section, and voxels_near.h uses this only up to a reach of MAX_ROW_REACH voxels.

#include "engine/annotation/sets/ball_rows.h"

namespace shvr {

/// The widest reach along an axis: a 64-bit word holds a brick's row and as many voxels on either side of it.
inline constexpr int64_t MAX_ROW_REACH = 16;

class NearRows {
public:
    /// Measures distances from the voxels of the set or, if `is_inverted`, of its complement in the volume.
    NearRows(const BrickSet& set, bool is_inverted, const Reach& reach);
    /// The voxels among `wanted`, of this brick, that are within reach.
    BrickBits search(int64_t brick, const BrickBits& wanted);

private:
    using Neighbours = std::array<const BrickBits*, 3>;  ///< bricks in a row along x; null: no voxel of the set
    uint64_t row(const Neighbours& bricks, const Size3& brick, int64_t y, int64_t z) const;
    bool gather(const Size3& brick);
    void add(std::span<const BallRow> ball, int64_t z, BrickBits& near) const;

    const BrickSet& set_;
    bool is_inverted_;
    Size3 size_, counts_, reach_;
    std::vector<BallRow> ball_;     ///< shortest rows first
    Size3 window_;                  ///< the size of a brick enlarged by the reach
    std::vector<uint64_t> rows_;    ///< by y and z in the window; bit x + MAX_ROW_REACH is voxel x of the brick
    std::vector<uint32_t> spread_;  ///< the brick's part of `rows_`
    std::vector<uint8_t> has_any_;  ///< by slice of the window: whether it has voxels
};

}  // namespace shvr
