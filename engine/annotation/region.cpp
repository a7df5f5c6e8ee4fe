#include "engine/annotation/region.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr int64_t MOST_REGION_VOXELS = 256;  // a side

/// First and one past the last voxel whose centre lies within `reach` of `centre`, by the test itself: the estimate
/// from floor() may be one off where the centre lies on the border.
struct Range {
    int64_t begin, end;
};
template <class Test>
Range range_where(double centre, double reach, int64_t count, const Test& holds)
{
    int64_t begin = int64_t(std::floor(std::clamp(centre - reach, -2.0, double(count) + 2.0))) - 1;
    int64_t end = int64_t(std::ceil(std::clamp(centre + reach, -2.0, double(count) + 2.0))) + 1;
    begin = std::clamp<int64_t>(begin, 0, count);
    end = std::clamp<int64_t>(end, 0, count);
    while (begin < end && !holds(begin)) ++begin;
    while (begin < end && !holds(end - 1)) --end;
    return {begin, end};
}

}  // namespace

bool BrushRegion::contains(const Size3& voxel) const
{
    if (glm::any(glm::lessThan(voxel, box.lower)) || glm::any(glm::greaterThanEqual(voxel, box.upper))) return false;
    const Size3 at = voxel - box.lower;
    const gpu::RowSpan& span = rows[size_t(at.y + box.size().y * at.z)];
    return at.x >= span.begin && at.x < span.end;
}

BrushRegion make_region(RegionShape shape, const glm::dvec3& centre, double radius_voxels, const glm::dvec3& spacing,
                        const Size3& volume_size)
{
    if (!(radius_voxels > 0.0) || !std::isfinite(radius_voxels))
        fail("brush radius is ", radius_voxels, " voxels; expected a number above 0");
    if (!std::isfinite(centre.x + centre.y + centre.z)) fail("brush position is not finite; expected three numbers");
    const double radius = radius_voxels * spacing.x;
    const auto squared = [&](int axis, int64_t voxel) {
        const double distance = (double(voxel) + 0.5 - centre[axis]) * spacing[axis];
        return distance * distance;
    };
    BrushRegion region;
    for (int axis = 0; axis < 3; ++axis) {
        const Range range = range_where(centre[axis], radius / spacing[axis], volume_size[axis],
                                        [&](int64_t voxel) { return squared(axis, voxel) <= radius * radius; });
        region.box.lower[axis] = range.begin;
        region.box.upper[axis] = range.end;
        if (range.end - range.begin > MOST_REGION_VOXELS)
            fail("brush radius is ", radius_voxels, " voxels: its region is ", range.end - range.begin,
                 " voxels wide; expected at most ", MOST_REGION_VOXELS);
    }
    const Size3 size = region.box.size();
    if (size.x * size.y * size.z == 0) {
        region.box = {};
        return region;
    }
    region.rows.reserve(size_t(size.y * size.z));
    for (int64_t z = region.box.lower.z; z < region.box.upper.z; ++z)
        for (int64_t y = region.box.lower.y; y < region.box.upper.y; ++y) {
            Range row{region.box.lower.x, region.box.upper.x};
            if (shape == RegionShape::ball) {
                const double yz = squared(1, y) + squared(2, z);
                const auto inside = [&](int64_t x) { return squared(0, x) + yz <= radius * radius; };
                while (row.begin < row.end && !inside(row.begin)) ++row.begin;
                while (row.begin < row.end && !inside(row.end - 1)) --row.end;
            }
            region.rows.push_back({int(row.begin - region.box.lower.x), int(row.end - region.box.lower.x)});
        }
    return region;
}

std::vector<glm::dvec3> stroke_positions(std::span<const glm::dvec3> path)
{
    constexpr double MOST_POSITIONS = 1e6;
    std::vector<glm::dvec3> positions;
    for (size_t i = 0; i < path.size(); ++i) {
        if (i > 0) {
            const glm::dvec3 way = glm::abs(path[i] - path[i - 1]);
            const double steps = std::ceil(std::max({way.x, way.y, way.z}));
            if (!(steps + double(positions.size()) < MOST_POSITIONS))
                fail("the stroke is ", steps, " voxels long; expected fewer than ", MOST_POSITIONS, " in all");
            for (double step = 1.0; step < steps; ++step)
                positions.push_back(glm::mix(path[i - 1], path[i], step / steps));
        }
        positions.push_back(path[i]);
    }
    return positions;
}

VoxelSelection::VoxelSelection(Size3 size)
    : size_(size), counts_((size + Size3(gpu::BRICK_SIZE - 1)) / Size3(gpu::BRICK_SIZE))
{
}

// A brick's row along x is one word of the selection. A word of the region covers parts of two of them.
void VoxelSelection::add(const BrushRegion& region, std::span<const uint32_t> words)
{
    constexpr int64_t SIDE = gpu::BRICK_SIZE;
    const Size3 size = region.box.size();
    const int64_t per_row = region.words_per_row();
    SHVR_CHECK(int64_t(words.size()) == per_row * size.y * size.z, words.size(), " words");
    const auto merge = [&](int64_t x, int64_t y, int64_t z, uint32_t bits) {
        if (bits == 0) return;
        const int64_t brick = x / SIDE + counts_.x * (y / SIDE + counts_.y * (z / SIDE));
        bricks_[brick][size_t(y % SIDE + SIDE * (z % SIDE))] |= bits;
    };
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t y = 0; y < size.y; ++y)
            for (int64_t w = 0; w < per_row; ++w) {
                const uint32_t word = words[size_t(w + per_row * (y + size.y * z))];
                if (word == 0) continue;
                const Size3 voxel = region.box.lower + Size3(32 * w, y, z);
                const int64_t shift = voxel.x % SIDE;
                merge(voxel.x, voxel.y, voxel.z, word << shift);
                if (shift > 0) merge(voxel.x + SIDE - shift, voxel.y, voxel.z, word >> (SIDE - shift));
            }
}

bool VoxelSelection::contains(const Size3& voxel) const
{
    const Size3 where = voxel / Size3(gpu::BRICK_SIZE), in = voxel % Size3(gpu::BRICK_SIZE);
    const auto found = bricks_.find(where.x + counts_.x * (where.y + counts_.y * where.z));
    return found != bricks_.end() && (found->second[size_t(in.y + gpu::BRICK_SIZE * in.z)] >> in.x & 1);
}

int64_t VoxelSelection::count() const
{
    int64_t sum = 0;
    for (const auto& [index, bits] : bricks_)
        for (uint32_t word : bits) sum += std::popcount(word);
    return sum;
}

std::vector<Change> paint_changes(const Mask& mask, const VoxelSelection& selection, uint8_t group)
{
    static const MaskBrick UNPAINTED{};
    std::vector<Change> changes;
    for (const auto& [index, bits] : selection.bricks()) {
        const MaskBrick* painted = mask.brick(index);
        const MaskBrick& before = painted ? *painted : UNPAINTED;
        MaskBrickChange change{.brick = index, .runs = {}};
        for (size_t row = 0; row < bits.size(); ++row)
            for (uint32_t left = bits[row]; left != 0; left &= left - 1) {
                const auto voxel = uint16_t(row * 32 + size_t(std::countr_zero(left)));
                if (before[voxel] == group) continue;
                if (!change.runs.empty() && change.runs.back().last + 1 == voxel &&
                    change.runs.back().before == before[voxel])
                    ++change.runs.back().last;
                else
                    change.runs.push_back({voxel, voxel, before[voxel], group});
            }
        if (!change.runs.empty()) changes.emplace_back(std::move(change));
    }
    return changes;
}

}  // namespace shvr
