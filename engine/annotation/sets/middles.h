#pragma once
// Balls in the middle of a set of voxels, at places on a grid of half voxels: the centres of voxels, of their faces and
// edges, and their corners. One thread; remembers the distance of every place that it looks at, about 56 bytes each.

#include <unordered_map>

#include "engine/annotation/sets/voxels_near.h"

namespace shvr {

/// A ball in volume space. Its radius is the middle of all radii with which it holds the same centres of voxels, as
/// many as it can with none outside of the set.
struct MiddleBall {
    glm::dvec3 position{0.0};
    double radius = 0.0;
};

class Middles {
public:
    /// `reach`: the grid; its distance is not used. What lies beyond the volume's border is not outside of the set.
    Middles(const BrickSet& set, const Reach& reach);
    /// Goes from a voxel of the set up to two voxels, by half voxels, while the distance to the outside grows.
    MiddleBall near(const Size3& voxel);

private:
    /// In half voxels: the centre of voxel v is at 2 v + 1.
    using Place = Size3;
    struct Known {
        double distance = 0.0;
        bool is_exact = false;  ///< otherwise the distance is at most this
    };
    double squared(int axis, const Place& from, int64_t at) const;
    /// The distance to the nearest centre of a voxel outside, if it is over `least`; otherwise a number up to `least`.
    double distance_of(const Place& place, double least);
    double measured(const Place& place, double least);
    double radius_at(const Place& place, double distance) const;
    /// The nearest voxel outside, from `first` on, in the row of y and z; -1: none before the volume's border.
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
    std::array<Slot, 64> slots_{};  ///< the bricks looked at last, by their positions modulo 4
};

}  // namespace shvr
