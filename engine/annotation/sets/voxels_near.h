#pragma once
// The voxels within a physical distance of a set of voxels. Distances are exact, Euclidean and between centres of
// voxels; each axis has its own spacing.
//
// Short distances: by rows of bits (near_rows.h). Others: in tiles of 64^3 voxels, computes the distance along x to the
// nearest voxel of the set, then minima of parabolas along y and z (Felzenszwalb and Huttenlocher 2012), over the tile
// and its surroundings within the distance. So the cost depends on the set and its surroundings, not on the size of the
// volume. One thread.

#include <map>
#include <vector>

#include "engine/annotation/sets/brick_bits.h"
#include "engine/base/progress.h"

namespace shvr {

/// A set of voxels of a volume, as sparse bricks by their index; a missing brick has no voxels of the set.
using BrickSet = std::map<int64_t, BrickBits>;

/// The grid of a volume's voxels, and a distance in the volume's unit.
struct Reach {
    const Mask& mask;  ///< gives size and bricks of the volume
    glm::dvec3 spacing{1.0};
    double distance = 0.0;
    /// The largest squared distance that counts as within `distance`. The tolerance allows for rounding: 3 voxels of
    /// 0.1 are within 0.3.
    double most_squared() const { return distance * distance * (1.0 + 1e-9); }
    /// The distance in voxels along each axis, rounded down. Fails if it exceeds MAX_REACH.
    Size3 voxels() const;
};
inline constexpr int64_t MAX_REACH = 512;

/// All bricks with voxels within reach of the set, and possibly other bricks near it; ascending.
std::vector<int64_t> bricks_near(const BrickSet& set, const Reach& reach);

/// The voxels of `bricks` (ascending) within reach of a voxel of the set.
BrickSet voxels_near(const BrickSet& set, std::span<const int64_t> bricks, const Reach& reach,
                     const Progress& progress);

/// The voxels of the set within reach of a voxel of the volume that is not in the set. Positions beyond the volume's
/// border belong to neither.
BrickSet rim_of(const BrickSet& set, const Reach& reach, const Progress& progress);

}  // namespace shvr
