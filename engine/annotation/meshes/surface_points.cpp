#include "engine/annotation/meshes/surface_points.h"

#include <algorithm>
#include <bit>

#include "engine/annotation/meshes/corner_sheets.h"
#include "engine/base/error.h"

namespace shvr {

namespace {

glm::ivec3 along(int axis)
{
    glm::ivec3 step(0);
    step[axis] = 1;
    return step;
}

void check_memory(uint64_t bytes, uint64_t memory)
{
    const auto mib = [](uint64_t size) { return (size + (uint64_t{1} << 20) - 1) >> 20; };
    if (memory == 0 || bytes <= memory) return;
    fail("the surfaces take ", mib(bytes), " MiB of memory; expected at most ", memory >> 20,
         " MiB, the budget of the host: use a larger --budget-host");
}

/// Whether voxels of a group are diagonal neighbours at the edge upwards along `axis`.
bool is_split(const std::array<uint8_t, 8>& octants, int axis)
{
    const auto group = [&](int quadrant) {
        return octants[size_t(1 << axis | (quadrant & 1) << (axis + 1) % 3 | (quadrant >> 1) << (axis + 2) % 3)];
    };
    const auto is_crossed = [&](int a, int b, int c, int d) {
        return group(a) != 0 && group(a) == group(b) && group(c) != group(a) && group(d) != group(a);
    };
    return is_crossed(0, 3, 1, 2) || is_crossed(1, 2, 0, 3);
}

/// The cells that hold the corners of painted bricks, ascending.
std::vector<int64_t> cells_of(const Mask& mask, const Size3& cell_counts)
{
    std::vector<int64_t> cells;
    for (const int64_t brick : mask.painted_bricks())
        for (int i = 0; i < 8; ++i) {
            const Size3 place = Size3(mask.position_of(brick)) + Size3(i & 1, i >> 1 & 1, i >> 2);
            if (glm::all(glm::lessThan(place, cell_counts))) cells.push_back(index_of(place, cell_counts));
        }
    std::ranges::sort(cells);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
}

/// Finds the points of a cell; false if it has none.
bool fill(const CellView& view, SurfaceCell& cell)
{
    constexpr int SIDE = CellView::SIDE;
    uint32_t count = 0;
    for (size_t word = 0; word < SurfaceCell::WORDS; ++word) {
        cell.preceding[word] = uint16_t(count);
        const int row = int(word * 64 / CellView::SIDE);
        if (view.is_uniform(row) && view.is_uniform(row + 1)) continue;  // a word holds two rows
        for (int bit = 0; bit < 64; ++bit) {
            const int index = int(word * 64) + bit;
            const std::array<uint8_t, 8> octants =
                view.octants({index % SIDE, index / SIDE % SIDE, index / (SIDE * SIDE)});
            if (std::ranges::all_of(octants, [&](uint8_t group) { return group == octants[0]; })) continue;
            cell.bits[word] |= uint64_t{1} << bit;
            ++count;
            for (const uint8_t group : octants) cell.groups.set(group);
        }
    }
    return count != 0;
}

uint32_t points_of(const SurfaceCell& cell)
{
    return uint32_t(cell.preceding.back()) + uint32_t(std::popcount(cell.bits.back()));
}

}  // namespace

SurfacePoints::SurfacePoints(const Mask& mask, uint64_t memory, const Progress& progress)
    : mask_(mask), cell_counts_(brick_grid(mask.size() + int64_t{1}))
{
    find_cells(memory, part_of(progress, 0.0, 0.6));
    marks_.assign(count_, 0);
    mark_splits(part_of(progress, 0.6, 1.0));
}

void SurfacePoints::find_cells(uint64_t memory, const Progress& progress)
{
    const std::vector<int64_t> found = cells_of(mask_, cell_counts_);
    const uint64_t bytes = found.size() * (sizeof(SurfaceCell) + 2 * sizeof(int64_t));
    check_memory(bytes, memory);
    cells_.reserve(found.size());
    CellView view;
    uint64_t count = 0;
    for (size_t i = 0; i < found.size(); ++i) {
        tell(progress, double(i) / double(found.size()));
        SurfaceCell& cell = cells_.emplace_back();
        cell.index = found[i];
        cell.place = position_of(cell.index, cell_counts_);
        cell.first = uint32_t(count);
        view.load_groups(mask_, cell.place);
        if (!fill(view, cell)) {
            cells_.pop_back();
            continue;
        }
        count += points_of(cell);
        check_memory(bytes + count * BYTES_PER_POINT, memory);
        if (count > UINT32_MAX) fail("the mask: has more than 4294967295 corners on surfaces; expected fewer");
    }
    count_ = uint32_t(count);
}

void SurfacePoints::mark_splits(const Progress& progress)
{
    CellView view;
    for (const SurfaceCell& cell : cells_) {
        tell(progress, 0.5 * double(&cell - cells_.data()) / double(cells_.size()));
        view.load(*this, cell);
        view.for_each_point([&](const glm::ivec3& corner, uint32_t point) {
            const std::array<uint8_t, 8> octants = view.octants(corner);
            for (int axis = 0; axis < 3; ++axis)
                if (is_split(octants, axis)) marks_[point] = uint8_t(marks_[point] | 1 << axis);
        });
    }
    for (const SurfaceCell& cell : cells_) {
        tell(progress, 0.5 + 0.5 * double(&cell - cells_.data()) / double(cells_.size()));
        view.load(*this, cell);
        view.for_each_point([&](const glm::ivec3& corner, uint32_t point) {
            const auto has = [&](const glm::ivec3& from, int axis) {
                return (marks_[view.point(from)] >> axis & 1) != 0;
            };
            for (int axis = 0; axis < 3; ++axis) {
                if (view.group(corner) == view.group(corner - along(axis))) continue;
                const int next = (axis + 1) % 3, last = (axis + 2) % 3;
                if (has(corner, next) || has(corner, last) || has(corner + along(next), last) ||
                    has(corner + along(last), next))
                    marks_[point] = uint8_t(marks_[point] | 8 << axis);
            }
        });
    }
}

const SurfaceCell* SurfacePoints::cell_at(const Size3& place) const
{
    if (glm::any(glm::greaterThanEqual(place, cell_counts_))) return nullptr;
    const auto at = std::ranges::lower_bound(cells_, index_of(place, cell_counts_), {}, &SurfaceCell::index);
    return at != cells_.end() && at->place == place ? &*at : nullptr;
}

void CellView::load_groups(const Mask& mask, const Size3& place)
{
    std::ranges::fill(groups_, uint8_t{0});
    for (int i = 0; i < 27; ++i) {
        const glm::ivec3 offset(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        const Size3 at = place + Size3(offset);
        if (glm::any(glm::lessThan(at, Size3(0))) || glm::any(glm::greaterThanEqual(at, mask.brick_counts()))) continue;
        const std::shared_ptr<const MaskBrick>& brick = mask.brick(index_of(at, mask.brick_counts()));
        if (!brick) continue;
        const glm::ivec3 lower = glm::max(SIDE * offset, glm::ivec3(-1));
        const glm::ivec3 upper = glm::min(SIDE * offset + SIDE, glm::ivec3(SIDE + 1));
        for (int z = lower.z; z < upper.z; ++z)
            for (int y = lower.y; y < upper.y; ++y) {
                const glm::ivec3 in_brick = glm::ivec3(lower.x, y, z) - SIDE * offset;
                const uint8_t* from = brick->data() + in_brick.x + SIDE * (in_brick.y + SIDE * in_brick.z);
                std::copy_n(from, upper.x - lower.x,
                            &groups_[size_t(lower.x + 1 + (SIDE + 2) * (y + 1 + (SIDE + 2) * (z + 1)))]);
            }
    }
}

void CellView::load(const SurfacePoints& points, const SurfaceCell& cell)
{
    load_groups(points.mask(), cell.place);
    for (int i = 0; i < 8; ++i)
        near_[size_t(i)] = i == 0 ? &cell : points.cell_at(cell.place + Size3(i & 1, i >> 1 & 1, i >> 2));
}

bool CellView::is_uniform(int row) const
{
    constexpr size_t ROW = SIDE + 2, SLICE = ROW * ROW;
    const uint8_t* at = &groups_[size_t(row % SIDE) * ROW + size_t(row / SIDE) * SLICE];
    return std::equal(at, at + SIDE, at + 1) && std::equal(at, at + SIDE + 1, at + ROW) &&
           std::equal(at, at + SIDE + 1, at + SLICE) && std::equal(at, at + SIDE + 1, at + SLICE + ROW);
}

std::array<uint8_t, 8> CellView::octants(const glm::ivec3& corner) const
{
    const uint8_t* at = &groups_[size_t(corner.x + (SIDE + 2) * (corner.y + (SIDE + 2) * corner.z))];
    constexpr int ROW = SIDE + 2, SLICE = ROW * ROW;
    return {at[0], at[1], at[ROW], at[ROW + 1], at[SLICE], at[SLICE + 1], at[SLICE + ROW], at[SLICE + ROW + 1]};
}

uint32_t CellView::point(const glm::ivec3& corner) const
{
    const int which = (corner.x == SIDE) | (corner.y == SIDE) << 1 | (corner.z == SIDE) << 2;
    const SurfaceCell* cell = near_[size_t(which)];
    SHVR_CHECK(cell != nullptr);
    const glm::ivec3 local = corner % SIDE;
    const size_t index = size_t(local.x + SIDE * (local.y + SIDE * local.z));
    const uint64_t bits = cell->bits[index / 64], bit = uint64_t{1} << index % 64;
    SHVR_CHECK((bits & bit) != 0);
    return cell->first + cell->preceding[index / 64] + uint32_t(std::popcount(bits & (bit - 1)));
}

}  // namespace shvr
