#pragma once
// Sums of a group's voxels, or weights, in the kernel around each voxel of a brick; a row of the brick at once.
//
// Median: a ball is a set of rows along x, and a row takes one subtraction of counts for each of a brick's 32 voxels in
// a row, for each group that occurs there; so a voxel costs the ball's cross-section, not its volume. Gaussian: three
// one-dimensional passes for each group, along x, y and z, over the rows that the group reaches, in the narrowest type
// that holds the sums exactly.

#include <array>
#include <span>
#include <vector>

#include "engine/annotation/operations/mask_edit.h"
#include "engine/annotation/sets/ball_rows.h"

namespace shvr {

/// The kernel must not extend beyond the bricks next to its own.
constexpr int64_t MAX_KERNEL = BRICK_SIDE;

/// A brick (`core`), and the voxels that its voxels' kernels reach (`box`), clipped to the volume; x fastest.
struct Surroundings {
    VoxelBox core{}, box{};
    std::vector<uint8_t> groups{};
    std::vector<uint8_t> held{};  ///< the groups that occur, ascending
    size_t index(const Size3& at) const { return size_t(index_of(at - box.lower, box.size())); }
};

Surroundings surroundings_of(int64_t brick, const Size3& kernel, MaskEdit& edit);

/// Counts a group's voxels in stretches of rows along x, for all voxels of a brick's row at once: the number before the
/// end of a stretch minus that before its begin. Numbers wrap at 256, which is more than a stretch has voxels.
class RowCounts {
public:
    static constexpr size_t SIDE = size_t(BRICK_SIDE);
    static_assert(2 * MAX_KERNEL + 1 < 256);
    /// Counts for voxels 0 ... 31 of a row of the brick.
    using Sums = std::array<uint32_t, SIDE>;

    RowCounts(const Surroundings& around, int64_t reach)
        : around_(around),
          reach_(reach),
          stride_(SIDE + 2 * size_t(reach) + 1),
          before_(size_t(around.box.size().y * around.box.size().z) * stride_),
          has_any_(size_t(around.box.size().y * around.box.size().z))
    {}
    /// Prepares the counts of the voxels for which `is_counted(group)` holds.
    template <class IsCounted>
    void prepare(const IsCounted& is_counted);
    /// The counts in the ball around each voxel of the row of the core at (y, z).
    Sums sums(std::span<const BallRow> ball, int64_t y, int64_t z) const;

private:
    const Surroundings& around_;
    int64_t reach_;
    size_t stride_;
    std::vector<uint8_t> before_;   ///< for each row of the box, from `reach_` voxels before the core on
    std::vector<uint8_t> has_any_;  ///< whether the row has counted voxels
};

template <class IsCounted>
void RowCounts::prepare(const IsCounted& is_counted)
{
    const VoxelBox& box = around_.box;
    const int64_t extent = box.size().x, lead = box.lower.x - (around_.core.lower.x - reach_);
    for (size_t row = 0; row < has_any_.size(); ++row) {
        const uint8_t* const groups = &around_.groups[row * size_t(extent)];
        uint8_t* const before = &before_[row * stride_];
        uint8_t count = 0;
        has_any_[row] = 0;
        for (int64_t i = 0; i < int64_t(stride_); ++i) {
            before[i] = count;
            const int64_t at = i - lead;
            if (at < 0 || at >= extent || !is_counted(groups[at])) continue;
            ++count;
            has_any_[row] = 1;
        }
    }
}

class GaussianSums {
public:
    static constexpr size_t SIDE = size_t(BRICK_SIDE);
    /// Weights at 0, 1, ... voxels along each axis; at most 1024 each.
    using Weights = std::array<std::vector<uint16_t>, 3>;
    using Sums = std::array<uint64_t, SIDE>;

    GaussianSums(const Surroundings& around, const Weights& weights);
    /// Computes the sums along x and y of the group's weights.
    void prepare(uint8_t group);
    /// The sums of the group's weights around each voxel of the row of the core at (y, z), and of those of all voxels.
    Sums row(int64_t y, int64_t z) const;
    Sums whole_row(int64_t y, int64_t z) const;

private:
    bool sum_along_x(std::span<const uint8_t> groups, uint8_t group, uint16_t* sums) const;
    void sum_along_y(int64_t z);
    uint64_t whole(int axis, int64_t at) const;

    const Surroundings& around_;
    const Weights& weights_;
    std::vector<uint16_t> along_x_;       ///< by x in the core, y and z in the box
    std::vector<uint32_t> along_y_;       ///< by x and y in the core, z in the box
    std::vector<uint8_t> has_x_, has_y_;  ///< whether a row of these has sums above 0
};

/// Those of a Gaussian whose sigma is half the distance.
GaussianSums::Weights gaussian_weights(const glm::dvec3& spacing, double distance, const Size3& kernel);

}  // namespace shvr
