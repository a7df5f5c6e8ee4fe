#pragma once
// The corners of voxels at which groups meet each other or unpainted voxels: the points that all surfaces share. They
// are numbered brick by brick, so a point is found by counting bits. A copy of a mask must not change meanwhile; one
// thread.

#include <array>
#include <bit>
#include <bitset>
#include <vector>

#include "engine/annotation/mask.h"
#include "engine/base/progress.h"

namespace shvr {

/// A brick of 32^3 corners. Corner (0, 0, 0) of it is the lower corner of the brick's first voxel.
struct SurfaceCell {
    static constexpr size_t WORDS = VOXELS_PER_BRICK / 64;
    int64_t index = 0;  ///< in the grid of cells
    Size3 place{0};
    uint32_t first = 0;                       ///< number of its first point
    std::bitset<256> groups;                  ///< that may have a face at one of its points
    std::array<uint64_t, WORDS> bits{};       ///< the corners that are points, x fastest
    std::array<uint16_t, WORDS> preceding{};  ///< points before each word
};

class SurfacePoints {
public:
    /// Bytes that a point and its smoothing take at most, in all: offsets, a copy of them, neighbours, marks, numbers.
    static constexpr uint64_t BYTES_PER_POINT = 56;

    /// Finds the points. Fails if they would take more than `memory` bytes; 0: no limit.
    SurfacePoints(const Mask& mask, uint64_t memory, const Progress& progress);

    const Mask& mask() const { return mask_; }
    const std::vector<SurfaceCell>& cells() const { return cells_; }
    /// Null if the cell has no points.
    const SurfaceCell* cell_at(const Size3& place) const;
    uint32_t count() const { return count_; }
    /// Bit `axis`: the edge upwards along the axis is split in the middle, since voxels of a group are diagonal
    /// neighbours there. Bit 3 + `axis`: the face across the axis whose lower corner is the point has such an edge.
    uint8_t marks(uint32_t point) const { return marks_[point]; }

private:
    void find_cells(uint64_t memory, const Progress& progress);
    void mark_splits(const Progress& progress);

    const Mask& mask_;
    Size3 cell_counts_;
    std::vector<SurfaceCell> cells_;
    uint32_t count_ = 0;
    std::vector<uint8_t> marks_;
};

/// The surroundings of one cell: groups of voxels -1 ... 32 along each axis, and points at corners 0 ... 32.
class CellView {
public:
    static constexpr int SIDE = int(BRICK_SIDE);
    CellView() : groups_(size_t(SIDE + 2) * (SIDE + 2) * (SIDE + 2)) {}

    void load_groups(const Mask& mask, const Size3& place);
    void load(const SurfacePoints& points, const SurfaceCell& cell);

    const SurfaceCell& cell() const { return *near_[0]; }
    uint8_t group(const glm::ivec3& voxel) const
    {
        return groups_[size_t(voxel.x + 1 + (SIDE + 2) * (voxel.y + 1 + (SIDE + 2) * (voxel.z + 1)))];
    }
    /// The groups of a corner's octants.
    std::array<uint8_t, 8> octants(const glm::ivec3& corner) const;
    /// Whether no corner of row `row` (y + 32 z) of the cell is a point.
    bool is_uniform(int row) const;
    /// The number of a point; the corner must be one (SHVR_CHECK).
    uint32_t point(const glm::ivec3& corner) const;
    /// Calls `visit(corner, point)` for each point of the cell, in ascending order.
    template <class Visit>
    void for_each_point(const Visit& visit) const
    {
        uint32_t number = cell().first;
        for (size_t word = 0; word < SurfaceCell::WORDS; ++word)
            for (uint64_t bits = cell().bits[word]; bits != 0; bits &= bits - 1) {
                const int index = int(word * 64) + std::countr_zero(bits);
                visit(glm::ivec3(index % SIDE, index / SIDE % SIDE, index / (SIDE * SIDE)), number++);
            }
    }

private:
    std::vector<uint8_t> groups_;
    std::array<const SurfaceCell*, 8> near_{};  ///< the cell, and those above it along x (bit 0), y and z
};

/// The octants that belong to a group, as bits.
inline uint8_t bits_of_group(const std::array<uint8_t, 8>& octants, uint8_t group)
{
    uint8_t bits = 0;
    for (size_t i = 0; i < octants.size(); ++i) bits = uint8_t(bits | (octants[i] == group) << i);
    return bits;
}

}  // namespace shvr
