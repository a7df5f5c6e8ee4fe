#pragma once
// The voxels within a physical distance of a set of voxels: exact Euclidean distance between centres of voxels, with a
// spacing of its own along each axis.
//
// In tiles of 64^3 voxels: the distance along x to the nearest voxel of the set, then minima of parabolas along y and z
// (Felzenszwalb and Huttenlocher 2012), over the tile and what reaches into it. So a set costs its surroundings,
// whatever the size of the volume. One thread.

#include <map>
#include <vector>

#include "engine/annotation/sets/brick_bits.h"
#include "engine/base/progress.h"

namespace shvr {

/// Voxels of a volume in sparse bricks; a brick that is missing is empty.
using BrickSet = std::map<int64_t, BrickBits>;

/// A volume's grid, and a distance in its unit.
struct Reach {
    const Mask& mask;  ///< gives size and bricks of the volume
    glm::dvec3 spacing{1.0};
    double distance = 0.0;
    /// The largest squared distance that counts as within `distance`: up to rounding, so that 3 voxels of 0.1 are
    /// within 0.3.
    double most_squared() const { return distance * distance * (1.0 + 1e-9); }
    /// Voxels along each axis. Fails if they are over MAX_REACH.
    Size3 voxels() const;
};
inline constexpr int64_t MAX_REACH = 512;

/// Bricks that hold a voxel within reach of the set, and maybe some more; ascending.
std::vector<int64_t> bricks_near(const BrickSet& set, const Reach& reach);

/// The voxels of `bricks` (ascending) within reach of a voxel of the set or, if `is_inverted`, of a voxel of the volume
/// that is not in the set. Beyond the volume's border nothing is in either.
BrickSet voxels_near(const BrickSet& set, bool is_inverted, std::span<const int64_t> bricks, const Reach& reach,
                     const Progress& progress);

}  // namespace shvr
