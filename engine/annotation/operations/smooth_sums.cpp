#include "engine/annotation/operations/smooth_sums.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace shvr {

namespace {

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

/// The groups that occur, ascending. Eight voxels that repeat those before them are compared at once.
std::vector<uint8_t> groups_in(std::span<const uint8_t> voxels)
{
    constexpr size_t WORD = sizeof(uint64_t);
    std::array<bool, 256> is_held{};
    for (size_t i = 0; i < voxels.size(); i += WORD) {
        const std::span<const uint8_t> word = voxels.subspan(i, std::min(WORD, voxels.size() - i));
        if (i >= WORD && std::memcmp(word.data(), word.data() - WORD, word.size()) == 0) continue;
        for (const uint8_t group : word) is_held[group] = true;
    }
    std::vector<uint8_t> held;
    for (size_t group = 0; group < is_held.size(); ++group)
        if (is_held[group]) held.push_back(uint8_t(group));
    return held;
}

/// Adds a row of sums, times a weight; the compiler multiplies several in an instruction.
template <class Sum, class From>
void add(std::array<Sum, GaussianSums::SIDE>& sums, const From* row, uint16_t weight)
{
    for (size_t x = 0; x < sums.size(); ++x) sums[x] = Sum(sums[x] + Sum(weight) * row[x]);
}

}  // namespace

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
    around.held = groups_in(around.groups);
    return around;
}

RowCounts::Sums RowCounts::sums(std::span<const BallRow> ball, int64_t y, int64_t z) const
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
    for (const BallRow& row : ball) {
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

GaussianSums::Weights gaussian_weights(const glm::dvec3& spacing, double distance, const Size3& kernel)
{
    GaussianSums::Weights weights;
    for (int axis = 0; axis < 3; ++axis)
        for (int64_t i = 0; i <= kernel[axis]; ++i) {
            const double sigmas = double(i) * spacing[axis] / (0.5 * distance);
            weights[size_t(axis)].push_back(uint16_t(std::lround(1024.0 * std::exp(-0.5 * sigmas * sigmas))));
        }
    return weights;
}

// A kernel ends at two sigmas and at MAX_KERNEL voxels, so its weights along an axis sum to less than 42'000: sums
// along one axis fit 16 bits, and those along two fit 32.
GaussianSums::GaussianSums(const Surroundings& around, const Weights& weights)
    : around_(around),
      weights_(weights),
      along_x_(SIDE * size_t(around.box.size().y * around.box.size().z)),
      along_y_(SIDE * size_t(around.core.size().y * around.box.size().z)),
      has_x_(along_x_.size() / SIDE),
      has_y_(along_y_.size() / SIDE)
{
    static_assert(MAX_KERNEL == 32);
}

/// The sums for one row of the box. Returns whether the row has voxels of the group.
bool GaussianSums::sum_along_x(std::span<const uint8_t> groups, uint8_t group, uint16_t* sums) const
{
    const std::vector<uint16_t>& weights = weights_[0];
    const size_t reach = weights.size() - 1, lead = size_t(around_.box.lower.x - around_.core.lower.x + int64_t(reach));
    std::array<uint16_t, SIDE + 2 * size_t(MAX_KERNEL)> is_group{};  // from `reach` voxels before the core on
    uint16_t has_any = 0;
    for (size_t x = 0; x < groups.size(); ++x) has_any |= is_group[lead + x] = uint16_t(groups[x] == group);
    if (has_any == 0) return false;
    std::array<uint16_t, SIDE> row{};
    for (size_t at = 0; at <= 2 * reach; ++at) add(row, &is_group[at], weights[at < reach ? reach - at : at - reach]);
    std::ranges::copy(row, sums);
    return true;
}

/// The sums for the rows of the core in slice z of the box, from those along x.
void GaussianSums::sum_along_y(int64_t z)
{
    const VoxelBox &core = around_.core, &box = around_.box;
    const std::vector<uint16_t>& weights = weights_[1];
    const auto reach = int64_t(weights.size()) - 1;
    for (int64_t y = core.lower.y; y < core.upper.y; ++y) {
        std::array<uint32_t, SIDE> row{};
        bool has_any = false;
        for (int64_t at = std::max(y - reach, box.lower.y); at <= std::min(y + reach, box.upper.y - 1); ++at) {
            const auto from = size_t(at - box.lower.y + box.size().y * (z - box.lower.z));
            if (has_x_[from] == 0) continue;
            has_any = true;
            add(row, &along_x_[SIDE * from], weights[size_t(std::abs(at - y))]);
        }
        const auto to = size_t(y - core.lower.y + core.size().y * (z - box.lower.z));
        has_y_[to] = has_any;
        if (has_any) std::ranges::copy(row, along_y_.begin() + int64_t(SIDE * to));
    }
}

void GaussianSums::prepare(uint8_t group)
{
    const VoxelBox& box = around_.box;
    const auto columns = size_t(box.size().x);
    for (size_t row = 0; row < has_x_.size(); ++row)
        has_x_[row] =
            sum_along_x(std::span(around_.groups).subspan(row * columns, columns), group, &along_x_[SIDE * row]);
    for (int64_t z = box.lower.z; z < box.upper.z; ++z) sum_along_y(z);
}

GaussianSums::Sums GaussianSums::row(int64_t y, int64_t z) const
{
    const VoxelBox &core = around_.core, &box = around_.box;
    const std::vector<uint16_t>& weights = weights_[2];
    const auto reach = int64_t(weights.size()) - 1;
    Sums sums{};
    for (int64_t at = std::max(z - reach, box.lower.z); at <= std::min(z + reach, box.upper.z - 1); ++at) {
        const auto from = size_t(y - core.lower.y + core.size().y * (at - box.lower.z));
        if (has_y_[from] != 0) add(sums, &along_y_[SIDE * from], weights[size_t(std::abs(at - z))]);
    }
    return sums;
}

/// The weights of all voxels of the volume along an axis, around a voxel of the core.
uint64_t GaussianSums::whole(int axis, int64_t at) const
{
    uint64_t sum = 0;
    const std::vector<uint16_t>& weights = weights_[size_t(axis)];
    const auto reach = int64_t(weights.size()) - 1;
    for (int64_t away = -reach; away <= reach; ++away)
        if (at + away >= around_.box.lower[axis] && at + away < around_.box.upper[axis])
            sum += weights[size_t(std::abs(away))];
    return sum;
}

GaussianSums::Sums GaussianSums::whole_row(int64_t y, int64_t z) const
{
    Sums sums{};
    for (int64_t x = around_.core.lower.x; x < around_.core.upper.x; ++x)
        sums[size_t(x - around_.core.lower.x)] = whole(0, x) * whole(1, y) * whole(2, z);
    return sums;
}

}  // namespace shvr
