// Smooths all groups jointly: a voxel gets the group with the greatest weight in the kernel around it; unpainted counts
// as a group. So a voxel only gets a group that occurs in its kernel, and becomes unpainted only if an unpainted voxel
// is in its kernel. Weights are integers, so the result does not depend on the order of summation.
//
// Median: a ball is a set of rows along x, and a row takes one subtraction of counts for each of a brick's 32 voxels in
// a row, for each group that occurs there; so a voxel costs the ball's cross-section, not its volume. Gaussian: three
// one-dimensional passes for each group that occurs in a brick's surroundings.

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/sets/voxels_near.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

/// The kernel must not extend beyond the bricks next to its own.
constexpr int64_t MAX_KERNEL = BRICK_SIDE;

/// A brick (`core`), and the voxels that its voxels' kernels reach (`box`), clipped to the volume; x fastest.
struct Surroundings {
    VoxelBox core{}, box{};
    std::vector<uint8_t> groups{};
    std::vector<uint8_t> held{};  ///< the groups that occur, ascending
    size_t index(const Size3& at) const { return size_t(index_of(at - box.lower, box.size())); }
};

/// A row of the kernel at offset (y, z) from its centre: the voxels from -half to half along x.
struct KernelRow {
    int64_t y = 0, z = 0, half = 0;
};

Size3 kernel_of(const SmoothOp& op, const MaskEdit& edit)
{
    const glm::dvec3& spacing = edit.input().volume.spacing;
    const Size3 voxels = Reach{edit.mask(), spacing, op.distance}.voxels();
    for (int axis = 0; axis < 3; ++axis)
        if (voxels[axis] > MAX_KERNEL)
            fail("the distance is ", op.distance, ", ", voxels[axis], " voxels along ", "xyz"[axis],
                 "; expected at most ", MAX_KERNEL, " voxels");
    return voxels;
}

/// The painted bricks, and the bricks that a kernel around a painted voxel may reach.
std::set<int64_t> bricks_around(const Mask& mask, const Size3& kernel)
{
    const Size3 counts = mask.brick_counts(), reach = glm::min(kernel, Size3(1));
    std::set<int64_t> bricks;
    for (const int64_t brick : mask.painted_bricks()) {
        const Size3 at = position_of(brick, counts), lower = glm::max(at - reach, Size3(0)),
                    upper = glm::min(at + reach, counts - int64_t{1});
        for (int64_t z = lower.z; z <= upper.z; ++z)
            for (int64_t y = lower.y; y <= upper.y; ++y)
                for (int64_t x = lower.x; x <= upper.x; ++x) bricks.insert(index_of(Size3(x, y, z), counts));
    }
    return bricks;
}

void read_part(int64_t brick, MaskEdit& edit, Surroundings& around)
{
    const VoxelBox own = edit.mask().box_of(brick);
    const MaskBrick& voxels = edit.read(brick);
    const Size3 lower = glm::max(own.lower, around.box.lower), upper = glm::min(own.upper, around.box.upper);
    for (int64_t z = lower.z; z < upper.z; ++z)
        for (int64_t y = lower.y; y < upper.y; ++y) {
            const auto from = voxels.begin() + index_of(Size3(lower.x, y, z) - own.lower, Size3(BRICK_SIDE));
            std::copy_n(from, upper.x - lower.x, around.groups.begin() + int64_t(around.index({lower.x, y, z})));
        }
}

Surroundings surroundings_of(int64_t brick, const Size3& kernel, MaskEdit& edit)
{
    const Mask& mask = edit.mask();
    const VoxelBox core = mask.box_of(brick);
    Surroundings around{.core = core,
                        .box = {glm::max(core.lower - kernel, Size3(0)), glm::min(core.upper + kernel, mask.size())}};
    const Size3 extent = around.box.size();
    around.groups.resize(size_t(extent.x * extent.y * extent.z));
    const Size3 first = around.box.lower / BRICK_SIDE, last = (around.box.upper - int64_t{1}) / BRICK_SIDE;
    for (int64_t z = first.z; z <= last.z; ++z)
        for (int64_t y = first.y; y <= last.y; ++y)
            for (int64_t x = first.x; x <= last.x; ++x)
                read_part(index_of(Size3(x, y, z), mask.brick_counts()), edit, around);
    std::array<bool, 256> is_held{};
    for (const uint8_t group : around.groups) is_held[group] = true;
    for (size_t group = 0; group < 256; ++group)
        if (is_held[group]) around.held.push_back(uint8_t(group));
    return around;
}

/// For each voxel of the core (x fastest), the group with the greatest weight among the groups offered so far. Stores
/// one weight per voxel, so memory does not grow with the number of groups.
class Winners {
public:
    explicit Winners(const Surroundings& around);
    /// Offer groups in ascending order: in a tie the voxel's own group wins, otherwise the group offered first.
    void offer(size_t voxel, uint8_t group, uint64_t weight)
    {
        if (weight < weights_[voxel] || (weight == weights_[voxel] && group != own_[voxel])) return;
        weights_[voxel] = weight;
        groups_[voxel] = group;
    }
    /// Offers group 0 after all others.
    void offer_unpainted(size_t voxel, uint64_t weight)
    {
        if (weight < weights_[voxel] || (weight == weights_[voxel] && groups_[voxel] == own_[voxel])) return;
        weights_[voxel] = weight;
        groups_[voxel] = 0;
    }
    std::span<const uint8_t> groups() const { return groups_; }

private:
    std::vector<uint8_t> own_, groups_;
    std::vector<uint64_t> weights_;
};

Winners::Winners(const Surroundings& around)
{
    const VoxelBox& core = around.core;
    for (int64_t z = core.lower.z; z < core.upper.z; ++z)
        for (int64_t y = core.lower.y; y < core.upper.y; ++y) {
            const auto from = around.groups.begin() + int64_t(around.index({core.lower.x, y, z}));
            own_.insert(own_.end(), from, from + core.size().x);
        }
    groups_ = own_;
    weights_.resize(own_.size());
}

std::vector<KernelRow> ball_of(const SmoothOp& op, const Size3& kernel, const MaskEdit& edit)
{
    const glm::dvec3& spacing = edit.input().volume.spacing;
    const double most = Reach{edit.mask(), spacing, op.distance}.most_squared();
    std::vector<KernelRow> rows;
    for (int64_t z = -kernel.z; z <= kernel.z; ++z)
        for (int64_t y = -kernel.y; y <= kernel.y; ++y) {
            int64_t half = kernel.x;
            const auto is_beyond = [&] {
                const glm::dvec3 away = glm::dvec3(double(half), double(y), double(z)) * spacing;
                return glm::dot(away, away) > most;
            };
            while (half >= 0 && is_beyond()) --half;
            if (half >= 0) rows.push_back({y, z, half});
        }
    return rows;
}

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
    Sums sums(std::span<const KernelRow> ball, int64_t y, int64_t z) const;

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

RowCounts::Sums RowCounts::sums(std::span<const KernelRow> ball, int64_t y, int64_t z) const
{
    constexpr int MAX_ROWS = 65535 / (2 * MAX_KERNEL + 1);  // then a sum of stretches still fits 16 bits
    const VoxelBox& box = around_.box;
    const int64_t rows = box.size().y;
    Sums sums{};
    std::array<uint16_t, SIDE> few{};
    int added = 0;
    const auto flush = [&] {
        for (size_t i = 0; i < SIDE; ++i) sums[i] += few[i];
        few.fill(0);
        added = 0;
    };
    for (const KernelRow& row : ball) {
        const int64_t at_y = y + row.y, at_z = z + row.z;
        if (at_y < box.lower.y || at_y >= box.upper.y || at_z < box.lower.z || at_z >= box.upper.z) continue;
        const auto index = size_t(at_y - box.lower.y + rows * (at_z - box.lower.z));
        if (has_any_[index] == 0) continue;
        const uint8_t* const begin = &before_[index * stride_ + size_t(reach_ - row.half)];
        const uint8_t* const end = begin + 2 * row.half + 1;
        for (size_t i = 0; i < SIDE; ++i) few[i] = uint16_t(few[i] + uint8_t(end[i] - begin[i]));
        if (++added == MAX_ROWS) flush();
    }
    flush();
    return sums;
}

Winners median_winners(const Surroundings& around, std::span<const KernelRow> ball, const Size3& kernel)
{
    const VoxelBox& core = around.core;
    Winners winners(around);
    RowCounts counts(around, kernel.x);
    const auto for_each_sum = [&](const auto& visit) {
        size_t first = 0;
        for (int64_t z = core.lower.z; z < core.upper.z; ++z)
            for (int64_t y = core.lower.y; y < core.upper.y; ++y, first += size_t(core.size().x)) {
                const RowCounts::Sums sums = counts.sums(ball, y, z);
                for (size_t x = 0; x < size_t(core.size().x); ++x) visit(first + x, sums[x]);
            }
    };
    // What no group has is unpainted, which saves a pass: most bricks hold one group.
    std::vector<uint32_t> painted(winners.groups().size());
    for (const uint8_t group : around.held) {
        if (group == 0) continue;
        counts.prepare([&](uint8_t each) { return each == group; });
        for_each_sum([&](size_t voxel, uint32_t sum) {
            painted[voxel] += sum;
            winners.offer(voxel, group, sum);
        });
    }
    if (around.held.front() != 0) return winners;
    if (around.box == VoxelBox{core.lower - kernel, core.upper + kernel}) {
        uint32_t whole = 0;
        for (const KernelRow& row : ball) whole += uint32_t(2 * row.half + 1);
        for (size_t voxel = 0; voxel < painted.size(); ++voxel) winners.offer_unpainted(voxel, whole - painted[voxel]);
    } else {  // the volume ends within the balls
        counts.prepare([](uint8_t) { return true; });
        for_each_sum([&](size_t voxel, uint32_t sum) { winners.offer_unpainted(voxel, sum - painted[voxel]); });
    }
    return winners;
}

/// Gaussian weights at 0, 1, ... voxels along an axis; at most 1024 each, so the product of three sums fits 64 bits.
std::vector<uint64_t> gaussian_along(double spacing, double distance, int64_t voxels)
{
    std::vector<uint64_t> weights;
    for (int64_t i = 0; i <= voxels; ++i) {
        const double sigmas = double(i) * spacing / (0.5 * distance);
        weights.push_back(uint64_t(std::llround(1024.0 * std::exp(-0.5 * sigmas * sigmas))));
    }
    return weights;
}

/// A weight for each voxel of a box, x fastest.
using Weights = std::vector<uint64_t>;

/// One pass along `axis` over the weights `from` of the voxels in `box`. Crops result and `box` to the core there.
Weights blurred(const Weights& from, VoxelBox& box, const VoxelBox& core, int axis, std::span<const uint64_t> along)
{
    VoxelBox cut = box;
    cut.lower[axis] = core.lower[axis];
    cut.upper[axis] = core.upper[axis];
    const Size3 extent = cut.size();
    const auto reach = int64_t(along.size()) - 1;
    Weights sums(size_t(extent.x * extent.y * extent.z));
    size_t next = 0;
    for (int64_t z = cut.lower.z; z < cut.upper.z; ++z)
        for (int64_t y = cut.lower.y; y < cut.upper.y; ++y)
            for (int64_t x = cut.lower.x; x < cut.upper.x; ++x, ++next) {
                Size3 at(x, y, z);
                const int64_t centre = at[axis], first = std::max(centre - reach, box.lower[axis]),
                              last = std::min(centre + reach, box.upper[axis] - 1);
                for (at[axis] = first; at[axis] <= last; ++at[axis])
                    sums[next] +=
                        along[size_t(std::abs(at[axis] - centre))] * from[size_t(index_of(at - box.lower, box.size()))];
            }
    box = cut;
    return sums;
}

Winners gaussian_winners(const Surroundings& around, std::span<const std::vector<uint64_t>, 3> along)
{
    Winners winners(around);
    for (const uint8_t group : around.held) {
        Weights weights(around.groups.size());
        std::ranges::transform(around.groups, weights.begin(), [&](uint8_t each) { return uint64_t(each == group); });
        VoxelBox box = around.box;
        for (int axis = 0; axis < 3; ++axis) weights = blurred(weights, box, around.core, axis, along[size_t(axis)]);
        for (size_t voxel = 0; voxel < weights.size(); ++voxel) winners.offer(voxel, group, weights[voxel]);
    }
    return winners;
}

/// The groups to smooth: a voxel changes only if its old or new group is among them.
GroupSet chosen_by(const SmoothOp& op)
{
    GroupSet chosen;
    if (op.groups.empty()) chosen.set();
    for (const uint8_t group : op.groups) chosen[group] = true;
    return chosen;
}

}  // namespace

void perform(const SmoothOp& op, MaskEdit& edit, const Progress& progress)
{
    const Size3 kernel = kernel_of(op, edit);
    const std::set<int64_t> around_painted = bricks_around(edit.mask(), kernel);
    const std::vector<int64_t> bricks(around_painted.begin(), around_painted.end());
    const std::vector<KernelRow> ball = ball_of(op, kernel, edit);
    const GroupSet chosen = chosen_by(op);
    std::array<std::vector<uint64_t>, 3> along;
    for (int axis = 0; axis < 3; ++axis)
        along[size_t(axis)] = gaussian_along(edit.input().volume.spacing[axis], op.distance, kernel[axis]);
    for_each_brick(bricks, progress, [&](int64_t brick) {
        if (!edit.may_change(brick)) return;
        const Surroundings around = surroundings_of(brick, kernel, edit);
        const auto is_chosen = [&](uint8_t group) { return chosen[group]; };
        if (around.held.size() == 1 || std::ranges::none_of(around.held, is_chosen)) return;
        const Winners winners = op.method == SmoothOp::Method::median ? median_winners(around, ball, kernel)
                                                                      : gaussian_winners(around, along);
        MaskBrick wanted = edit.read(brick);
        const Size3 extent = around.core.size();
        for (size_t i = 0; i < winners.groups().size(); ++i) {
            uint8_t& voxel = wanted[size_t(index_of(position_of(int64_t(i), extent), Size3(BRICK_SIDE)))];
            const uint8_t winner = winners.groups()[i];
            if (chosen[voxel] || chosen[winner]) voxel = winner;
        }
        edit.want(brick, wanted);
    });
}

}  // namespace shvr
