#pragma once
// Balls in the middle of a set of voxels. Their centres lie on a grid of half voxels: centres of voxels, of faces and
// of edges, and corners. One thread. Caches the distance at every place that it evaluates, about 56 bytes each.

#include <unordered_map>

#include "engine/annotation/sets/voxels_near.h"

namespace shvr {

/// A ball in volume space. It contains as many voxel centres as possible without one outside the set; its radius is the
/// middle of the range of radii that contain just these centres.
struct MiddleBall {
    glm::dvec3 position{0.0};
    double radius = 0.0;
};

class Middles {
public:
    /// Uses the grid of `reach`, but not its distance. Positions beyond the volume do not count as outside the set.
    Middles(const BrickSet& set, const Reach& reach);
    /// Climbs from a voxel of the set, by up to four steps of half a voxel, while the distance to the outside grows.
    MiddleBall near(const Size3& voxel);

private:
    /// A position in half voxels: the centre of voxel v is at 2 v + 1.
    using Place = Size3;
    struct Known {
        double distance = 0.0;
        bool is_exact = false;  ///< false: `distance` is only an upper bound
    };
    double squared(int axis, const Place& from, int64_t at) const;
    /// The distance to the nearest voxel centre outside if it exceeds `least`; otherwise an upper bound up to `least`.
    double distance_of(const Place& place, double least);
    double measured(const Place& place, double least);
    double radius_at(const Place& place, double distance) const;
    /// The x of the nearest voxel outside the set in the row of `first`, from `first` down (or up); -1: none.
    int64_t outside_below(Size3 first);
    int64_t outside_above(Size3 first);
    uint32_t row_of(const Size3& voxel);

    const BrickSet& set_;
    Size3 size_, counts_;
    glm::dvec3 spacing_;
    std::unordered_map<int64_t, Known> known_{};
    struct Slot {
        int64_t brick = -1;
        const BrickBits* bits = nullptr;
    };
    std::array<Slot, 64> slots_{};  ///< cache of the bricks used last, by their positions modulo 4
};

}  // namespace shvr
