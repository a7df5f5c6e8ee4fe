#pragma once
// A ball of voxels as rows along x.

#include <vector>

#include "engine/annotation/sets/voxels_near.h"

namespace shvr {

/// A row of the ball at offset (y, z) from its centre: the voxels from -half to half along x.
struct BallRow {
    int64_t y = 0, z = 0, half = 0;
};

/// The ball of the voxels within reach of a voxel. Fails if the reach exceeds MAX_REACH.
std::vector<BallRow> ball_rows(const Reach& reach);

}  // namespace shvr
