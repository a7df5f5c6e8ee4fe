#include "engine/annotation/region.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

constexpr int64_t MAX_REGION_VOXELS = int64_t{1} << 24;  // 256 x 256 x 256; each row counts as whole 32-bit words

struct Range {
    int64_t begin, end;
};

/// Returns the range of `within` from the first to the last position that satisfies `holds`. The estimate (`reach` on
/// both sides of `centre`) only gives the start of the search; the test `holds` decides.
template <class Test>
Range range_where(double centre, double reach, const Range& within, const Test& holds)
{
    constexpr double FAR_AWAY = 1 << 22;  // beyond this many voxels, and for NaN, the estimate is not used
    Range range = within;
    if (reach < FAR_AWAY && std::abs(centre) < FAR_AWAY) {
        range.begin = std::clamp(int64_t(std::floor(centre - reach)) - 1, within.begin, within.end);
        range.end = std::clamp(int64_t(std::ceil(centre + reach)) + 1, within.begin, within.end);
    }
    while (range.begin < range.end && !holds(range.begin)) ++range.begin;
    while (range.begin < range.end && !holds(range.end - 1)) --range.end;
    return range;
}

/// The bits of the span that lie in word `word` of its row, at their positions in the word.
uint32_t span_bits(const gpu::RowSpan& span, int64_t word)
{
    const int64_t begin = std::max<int64_t>(span.begin - 32 * word, 0);
    const int64_t end = std::min<int64_t>(span.end - 32 * word, 32);
    return begin < end ? ~uint32_t{0} >> (32 - (end - begin)) << begin : 0;
}

/// Number of steps from a to b; at least 1, so that two equal points still give two positions of the stroke.
double steps_between(const glm::dvec3& a, const glm::dvec3& b)
{
    const glm::dvec3 way = glm::abs(b - a);
    return std::max(1.0, std::ceil(std::max({way.x, way.y, way.z})));
}

bool is_inside(const Size3& voxel, const Size3& size)
{
    return glm::all(glm::greaterThanEqual(voxel, Size3(0))) && glm::all(glm::lessThan(voxel, size));
}

void refuse_size(double radius_voxels, const Size3& size)
{
    if ((size.x + 31) / 32 * 32 * size.y * size.z > MAX_REGION_VOXELS)
        fail("brush radius is ", radius_voxels, " voxels: its region is ", size.x, " x ", size.y, " x ", size.z,
             " voxels; expected at most ", MAX_REGION_VOXELS,
             " (256 x 256 x 256), each row filled up to a multiple of 32");
}

}  // namespace

bool BrushRegion::contains(const Size3& voxel) const
{
    if (glm::any(glm::lessThan(voxel, box.lower)) || glm::any(glm::greaterThanEqual(voxel, box.upper))) return false;
    const Size3 at = voxel - box.lower;
    const gpu::RowSpan& span = rows[size_t(at.y + box.size().y * at.z)];
    return at.x >= span.begin && at.x < span.end;
}

void check_radius(double radius_voxels, const glm::dvec3& spacing, const Size3& volume_size)
{
    // Depending on whether a region is centred on a voxel or between two, its size along an axis is odd or even.
    const glm::dvec3 reach = glm::min(radius_voxels * spacing.x / spacing, glm::dvec3(volume_size));
    const Size3 widest = glm::max(2l * Size3(glm::floor(reach)) + 1l, 2l * Size3(glm::floor(reach + 0.5)));
    refuse_size(radius_voxels, glm::min(widest, volume_size));
}

BrushRegion make_region(RegionShape shape, const glm::dvec3& centre_voxel, double radius_voxels,
                        const glm::dvec3& spacing, const Size3& volume_size)
{
    if (!(radius_voxels > 0.0) || !std::isfinite(radius_voxels))
        fail("brush radius is ", radius_voxels, " voxels; expected a number above 0");
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(centre_voxel[axis]))
            fail("brush position along ", "xyz"[axis], " is ", centre_voxel[axis], "; expected a finite number");
    const double radius = radius_voxels * spacing.x;
    const auto squared = [&](int axis, int64_t voxel) {
        const double distance = (double(voxel) + 0.5 - centre_voxel[axis]) * spacing[axis];
        return distance * distance;
    };
    BrushRegion region;
    for (int axis = 0; axis < 3; ++axis) {
        const Range range = range_where(centre_voxel[axis], radius / spacing[axis], {0, volume_size[axis]},
                                        [&](int64_t voxel) { return squared(axis, voxel) <= radius * radius; });
        if (range.begin == range.end) return {};
        region.box.lower[axis] = range.begin;
        region.box.upper[axis] = range.end;
    }
    const Size3 size = region.box.size();
    refuse_size(radius_voxels, size);
    region.rows.reserve(size_t(size.y * size.z));
    for (int64_t z = region.box.lower.z; z < region.box.upper.z; ++z)
        for (int64_t y = region.box.lower.y; y < region.box.upper.y; ++y) {
            Range row{region.box.lower.x, region.box.upper.x};
            if (shape == RegionShape::ball) {
                const double left = radius * radius - squared(1, y) - squared(2, z);
                const double reach = left <= 0.0 ? 0.0 : std::sqrt(left) / spacing.x;
                row = range_where(centre_voxel.x, reach, row, [&](int64_t x) {
                    return squared(0, x) + squared(1, y) + squared(2, z) <= radius * radius;
                });
            }
            region.rows.push_back({int(row.begin - region.box.lower.x), int(row.end - region.box.lower.x)});
        }
    return region;
}

double stroke_position_count(std::span<const glm::dvec3> path)
{
    double count = path.empty() ? 0.0 : 1.0;
    for (size_t i = 1; i < path.size(); ++i) count += steps_between(path[i - 1], path[i]);
    return count;
}

std::vector<glm::dvec3> stroke_positions(std::span<const glm::dvec3> path)
{
    const double count = stroke_position_count(path);
    if (!(count <= double(MAX_STROKE_POSITIONS)))
        fail("the stroke makes ", count, " positions a voxel apart; expected at most ", MAX_STROKE_POSITIONS);
    std::vector<glm::dvec3> positions;
    positions.reserve(size_t(count));
    for (size_t i = 0; i < path.size(); ++i) {
        const double steps = i == 0 ? 1.0 : steps_between(path[i - 1], path[i]);
        for (double step = 1.0; step < steps; ++step) positions.push_back(glm::mix(path[i - 1], path[i], step / steps));
        positions.push_back(path[i]);
    }
    return positions;
}

VoxelSelection::VoxelSelection(Size3 size) : size_(size), counts_(brick_grid(size)) {}

// A row of a brick is one word of the selection; a word of the region may extend over two such words. `row_of_bricks`
// caches the bricks while the region's rows stay in the same row of bricks.
void VoxelSelection::add(const BrushRegion& region, std::span<const uint32_t> words)
{
    const Size3 size = region.box.size();
    const int64_t per_row = region.words_per_row();
    SHVR_CHECK(int64_t(words.size()) == per_row * size.y * size.z, words.size(), " words");
    SHVR_CHECK(glm::all(glm::lessThanEqual(region.box.upper, size_)), "the region is of another volume");
    if (words.empty()) return;
    const int64_t first_brick = region.box.lower.x / BRICK_SIDE, shift = region.box.lower.x % BRICK_SIDE;
    std::vector<Bits*> row_of_bricks(size_t(per_row + 1));
    const auto merge = [&](int64_t i, int64_t y, int64_t z, uint32_t bits) {
        if (bits == 0) return;
        Bits*& brick = row_of_bricks[size_t(i)];
        if (!brick) brick = &bricks_[first_brick + i + counts_.x * (y / BRICK_SIDE + counts_.y * (z / BRICK_SIDE))];
        (*brick)[size_t(y % BRICK_SIDE + BRICK_SIDE * (z % BRICK_SIDE))] |= bits;
    };
    size_t row = 0;
    for (int64_t z = region.box.lower.z; z < region.box.upper.z; ++z)
        for (int64_t y = region.box.lower.y; y < region.box.upper.y; ++y, ++row) {
            if (y == region.box.lower.y || y % BRICK_SIDE == 0)
                std::fill(row_of_bricks.begin(), row_of_bricks.end(), nullptr);
            for (int64_t w = 0; w < per_row; ++w) {
                // This mask excludes voxels outside the spans, even if a kernel selected some by mistake.
                const uint32_t word = words[row * size_t(per_row) + size_t(w)] & span_bits(region.rows[row], w);
                merge(w, y, z, word << shift);
                if (shift > 0) merge(w + 1, y, z, word >> (BRICK_SIDE - shift));
            }
        }
}

bool VoxelSelection::contains(const Size3& voxel) const
{
    if (!is_inside(voxel, size_)) return false;
    const Size3 where = voxel / BRICK_SIDE, in = voxel % BRICK_SIDE;
    const auto found = bricks_.find(index_of(where, counts_));
    return found != bricks_.end() && (found->second[size_t(in.y + BRICK_SIDE * in.z)] >> in.x & 1) != 0;
}

int64_t VoxelSelection::count() const
{
    int64_t sum = 0;
    for (const auto& [index, bits] : bricks_)
        for (const uint32_t word : bits) sum += std::popcount(word);
    return sum;
}

}  // namespace shvr
