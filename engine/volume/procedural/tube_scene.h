#pragma once
// Tubes, and which of them is near a position. A tube is the union of the balls along a straight line whose radius goes
// evenly from one end to the other (a round cone). Distances take sums, products, divisions and square roots alone, so
// that their bits are equal on every machine. An immutable scene; any thread may ask.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

struct Tube {
    std::array<glm::dvec3, 2> ends{};       ///< voxel coordinates
    std::array<double, 2> radii{1.0, 1.0};  ///< voxels
    uint8_t group = 0;                      ///< colour group in the truth's mask; 0: none, for a stone
    std::array<double, 2> intensity{200.0, 200.0};
    /// Of the length, at each end, what is seen: between the two the intensity is `gap_intensity`. 0.5: all of it.
    double seen = 0.5;
    double gap_intensity = 0.0;
};

/// From a tube's surface, in voxels, negative inside: exact outside, and inside up to the other side of its axis.
/// `along` is 0 at the first end, 1 at the second.
struct TubeDistance {
    double voxels = 0.0;
    double along = 0.0;
};
TubeDistance distance_from(const Tube& tube, const glm::dvec3& voxel);

class TubeScene {
public:
    /// `reach`: how far from its surface a tube is asked for, in voxels. Tubes may leave the volume.
    TubeScene(std::vector<Tube> tubes, const Size3& size, double reach);

    const std::vector<Tube>& tubes() const { return tubes_; }

    /// All tubes whose surface may be within `reach` of a position, in the order given, and perhaps others. The same
    /// for every position of a cell; outside the volume those of the nearest cell.
    std::span<const uint32_t> near(const glm::dvec3& voxel) const;

    /// The group of the tube in which the position lies deepest, of several the first; 0: it lies in none. Tubes end a
    /// millionth of a voxel outside their surface: the balls of a trace along the axes lie in them to the last voxel,
    /// however their distances are rounded.
    uint8_t group(const glm::dvec3& voxel) const;

private:
    struct CellRange {
        Size3 lower, upper;
    };
    CellRange cells_of(const Tube& tube, double reach) const;

    std::vector<Tube> tubes_;
    glm::dvec3 cell_;  ///< voxels
    Size3 counts_;
    std::vector<uint32_t> first_;  ///< by cell, of `lists_`; one more at the end
    std::vector<uint32_t> lists_;
};

}  // namespace shvr
