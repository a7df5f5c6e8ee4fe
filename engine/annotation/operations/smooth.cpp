// Smooths all groups jointly: a voxel gets the group with the greatest weight in the kernel around it; unpainted counts
// as a group. So a voxel only gets a group that occurs in its kernel, and becomes unpainted only if an unpainted voxel
// is in its kernel. Weights are integers, so the result does not depend on the order of summation.
// Where the sums come from: smooth_sums.h.

#include <algorithm>
#include <set>

#include "engine/annotation/operations/group_bricks.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/operations/smooth_sums.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

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

/// The winners by the groups' weights: `prepare(group)` before `sums(y, z)` returns them for a row of the core; and by
/// the weights of all voxels in the kernels of a row, `wholes(y, z)`.
template <class Prepare, class Sums, class Wholes>
Winners winners_of(const Surroundings& around, const Prepare& prepare, const Sums& sums, const Wholes& wholes)
{
    const VoxelBox& core = around.core;
    Winners winners(around);
    const auto for_each_row = [&](const auto& visit) {
        size_t first = 0;
        for (int64_t z = core.lower.z; z < core.upper.z; ++z)
            for (int64_t y = core.lower.y; y < core.upper.y; ++y, first += size_t(core.size().x)) visit(first, y, z);
    };
    const auto columns = size_t(core.size().x);
    // What no group has is unpainted, which saves a pass: most bricks hold one group.
    std::vector<uint64_t> painted(winners.groups().size());
    for (const uint8_t group : around.held) {
        if (group == 0) continue;
        prepare(group);
        for_each_row([&](size_t first, int64_t y, int64_t z) {
            const auto row = sums(y, z);
            for (size_t x = 0; x < columns; ++x) {
                painted[first + x] += row[x];
                winners.offer(first + x, group, row[x]);
            }
        });
    }
    if (around.held.front() != 0) return winners;
    for_each_row([&](size_t first, int64_t y, int64_t z) {
        const auto row = wholes(y, z);
        for (size_t x = 0; x < columns; ++x) winners.offer_unpainted(first + x, row[x] - painted[first + x]);
    });
    return winners;
}

Winners median_winners(const Surroundings& around, std::span<const BallRow> ball, const Size3& kernel)
{
    RowCounts counts(around, kernel.x), all(around, kernel.x);
    const VoxelBox& core = around.core;
    const bool is_whole = around.box == VoxelBox{core.lower - kernel, core.upper + kernel};
    RowCounts::Sums whole{};
    for (const BallRow& row : ball)
        for (uint32_t& sum : whole) sum += uint32_t(2 * row.half + 1);
    if (!is_whole) all.prepare([](uint8_t) { return true; });  // the volume ends within the balls
    return winners_of(
        around, [&](uint8_t group) { counts.prepare([&](uint8_t each) { return each == group; }); },
        [&](int64_t y, int64_t z) { return counts.sums(ball, y, z); },
        [&](int64_t y, int64_t z) { return is_whole ? whole : all.sums(ball, y, z); });
}

Winners gaussian_winners(const Surroundings& around, const GaussianSums::Weights& along)
{
    GaussianSums sums(around, along);
    return winners_of(
        around, [&](uint8_t group) { sums.prepare(group); }, [&](int64_t y, int64_t z) { return sums.row(y, z); },
        [&](int64_t y, int64_t z) { return sums.whole_row(y, z); });
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
    const std::vector<BallRow> ball = ball_rows({edit.mask(), edit.input().volume.spacing, op.distance});
    const GroupSet chosen = chosen_by(op);
    const GaussianSums::Weights along = gaussian_weights(edit.input().volume.spacing, op.distance, kernel);
    for_each_brick(bricks, progress, [&](int64_t brick) {
        if (!edit.may_change(brick)) return;
        const Surroundings around = surroundings_of(brick, kernel, edit);
        const auto is_chosen = [&](uint8_t group) { return chosen[group]; };
        if (around.held.size() == 1 || std::ranges::none_of(around.held, is_chosen)) return;
        const Winners winners = op.method == SmoothOp::Method::median ? median_winners(around, ball, kernel)
                                                                      : gaussian_winners(around, along);
        MaskBrick wanted = edit.read(brick);
        const Size3 extent = around.core.size();
        size_t next = 0;
        for (int64_t row = 0; row < extent.y * extent.z; ++row)
            for (int64_t x = 0; x < extent.x; ++x, ++next) {
                uint8_t& voxel = wanted[size_t(index_of({x, row % extent.y, row / extent.y}, Size3(BRICK_SIDE)))];
                const uint8_t winner = winners.groups()[next];
                if (chosen[voxel] || chosen[winner]) voxel = winner;
            }
        edit.want(brick, wanted);
    });
}

}  // namespace shvr
