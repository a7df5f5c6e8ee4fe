#pragma once
// Tubes, and a lookup of the tubes near a position. A tube is the union of balls along a straight line, with radii that
// vary linearly from one end to the other (a round cone). Distances use only sums, products, divisions and square
// roots, so that their bits are equal on every machine. The scene is immutable; any thread may call it.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

struct Tube {
    std::array<glm::dvec3, 2> ends{};       ///< voxel coordinates
    std::array<double, 2> radii{1.0, 1.0};  ///< voxels
    uint8_t group = 0;                      ///< colour group in the ground-truth mask; 0: not in the mask
    uint8_t tissue = 0;                     ///< group in the mask of tissues if `group` is 0
    std::array<double, 2> intensity{200.0, 200.0};
    /// The fraction of the length that is visible at each end; the part between them has `gap_intensity`. 0.5: all is
    /// visible; negative: nothing.
    double seen = 0.5;
    double gap_intensity = 0.0;
};

/// The signed distance from a tube's surface in voxels, negative inside. Inside, it is measured to the surface on the
/// position's own side of the axis. `along` is 0 at the first end, 1 at the second.
struct TubeDistance {
    double voxels = 0.0;
    double along = 0.0;
};
TubeDistance distance_from(const Tube& tube, const glm::dvec3& voxel);

class TubeScene {
public:
    /// `reach`: largest distance in voxels from a tube's surface that `near` must cover. Tubes may leave the volume.
    TubeScene(std::vector<Tube> tubes, const Size3& size, double reach);

    const std::vector<Tube>& tubes() const { return tubes_; }

    /// Returns all tubes whose surface may be within `reach` of a position, and perhaps more, in the constructor's
    /// order. All positions of a cell give the same result; positions outside the volume give that of the nearest cell.
    std::span<const uint32_t> near(const glm::dvec3& voxel) const;

    /// Returns the group of the tube in which the position lies deepest (of equally deep tubes, the first one); 0
    /// outside all tubes. Tubes are enlarged by a millionth of a voxel, so that the balls of a trace along their axes
    /// lie entirely in them, independently of rounding.
    uint8_t group(const glm::dvec3& voxel) const;

private:
    struct CellRange {
        Size3 lower, upper;
    };
    CellRange cells_of(const Tube& tube, double reach) const;

    std::vector<Tube> tubes_;
    glm::dvec3 cell_;  ///< voxels
    Size3 counts_;
    std::vector<uint32_t> first_;  ///< for each cell its first index in `lists_`, and an end index for the last cell
    std::vector<uint32_t> lists_;
};

}  // namespace shvr
