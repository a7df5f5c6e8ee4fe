#include "engine/annotation/sets/brick_components.h"

#include <algorithm>

#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr int SIDE = int(BRICK_SIDE);
constexpr uint32_t NO_LABEL = ~0u;

/// The range of y (or z) in another brick, `offset` bricks away along this axis, that touches `at` in this brick.
struct Touching {
    int first, last;
};
Touching touching(int at, int64_t offset)
{
    const int middle = at - SIDE * int(offset);  // in coordinates of the other brick
    return {std::max(middle - 1, 0), std::min(middle + 1, SIDE - 1)};
}

}  // namespace

void BrickComponents::add(int64_t index, const BrickBits& bits)
{
    SHVR_CHECK(bricks_.empty() || bricks_.rbegin()->first < index);
    Brick& brick = bricks_[index];
    label(brick, bits);
    const Size3 position = position_of(index, counts_);
    for (int64_t z = -1; z <= 0; ++z)
        for (int64_t y = -1; y <= 1; ++y)
            for (int64_t x = -1; x <= 1; ++x) {
                const Size3 offset(x, y, z), at = position + offset;
                const bool is_before = z < 0 || (z == 0 && (y < 0 || (y == 0 && x < 0)));
                const bool is_face = x * x + y * y + z * z == 1;
                if (!is_before || (!is_26_ && !is_face) || glm::any(glm::lessThan(at, Size3(0))) ||
                    glm::any(glm::greaterThanEqual(at, counts_)))
                    continue;
                const auto found = bricks_.find(index_of(at, counts_));
                if (found != bricks_.end()) join_bricks(brick, found->second, offset);
            }
}

void BrickComponents::label(Brick& brick, const BrickBits& bits)
{
    for (size_t row = 0; row < bits.size(); ++row) {
        brick.rows[row] = uint32_t(brick.runs.size());
        for (uint32_t left = bits[row]; left != 0;) {
            const int first = std::countr_zero(left), length = std::countr_one(left >> first);
            brick.runs.push_back({uint8_t(first), uint8_t(first + length - 1), NO_LABEL});
            left = first + length == 32 ? 0 : left >> (first + length) << (first + length);
        }
        brick.rows[row + 1] = uint32_t(brick.runs.size());
        const int y = int(row) % SIDE, z = int(row) / SIDE;
        const int reach = is_26_ ? 1 : 0;
        if (y > 0) join_rows(brick.row(row), brick.row(row - 1), 0, reach);
        if (z > 0) join_rows(brick.row(row), brick.row(row - SIDE), 0, reach);
        if (is_26_ && z > 0 && y > 0) join_rows(brick.row(row), brick.row(row - SIDE - 1), 0, reach);
        if (is_26_ && z > 0 && y + 1 < SIDE) join_rows(brick.row(row), brick.row(row - SIDE + 1), 0, reach);
        for (Run& run : brick.row(row))
            if (run.label == NO_LABEL) run.label = forest_.add();
    }
    if (forest_.size() + VOXELS_PER_BRICK >= NO_LABEL)
        fail("the group has too many parts; expected less than ", NO_LABEL);
    brick.runs.shrink_to_fit();
}

void BrickComponents::join_bricks(Brick& brick, Brick& other, const Size3& offset)
{
    for (int z = 0; z < SIDE; ++z) {
        const Touching slices = touching(z, offset.z);
        for (int y = 0; y < SIDE && slices.first <= slices.last; ++y) {
            const Touching rows = touching(y, offset.y);
            for (int w = slices.first; w <= slices.last; ++w)
                for (int v = rows.first; v <= rows.last; ++v) {
                    const int dy = std::abs(v + SIDE * int(offset.y) - y), dz = std::abs(w + SIDE * int(offset.z) - z);
                    if (!is_26_ && dy + dz + std::abs(int(offset.x)) != 1) continue;
                    join_rows(brick.row(size_t(y + SIDE * z)), other.row(size_t(v + SIDE * w)), offset.x,
                              is_26_ ? 1 : 0);
                }
        }
    }
}

/// Joins runs of two rows that touch. `offset`: position of the other row's brick minus this one's, along x. A run of
/// `row` without a label gets the label of the first run that it touches.
void BrickComponents::join_rows(std::span<Run> row, std::span<Run> other, int64_t offset, int reach)
{
    const int shift = SIDE * int(offset);
    if (offset != 0) reach = 1;  // across a face, next to each other
    for (size_t i = 0, k = 0; i < row.size() && k < other.size();) {
        Run& run = row[i];
        const int first = other[k].first + shift, last = other[k].last + shift;
        if (first <= run.last + reach && run.first <= last + reach)
            run.label = run.label == NO_LABEL ? other[k].label : forest_.join(run.label, other[k].label);
        if (run.last < last)
            ++i;
        else
            ++k;
    }
}

std::vector<int64_t> BrickComponents::bricks() const
{
    std::vector<int64_t> indices;
    for (const auto& [index, brick] : bricks_) indices.push_back(index);
    return indices;
}

std::span<const BrickComponents::Run> BrickComponents::runs(int64_t brick, size_t row) const
{
    const Brick& found = bricks_.at(brick);
    return std::span(found.runs).subspan(found.rows[row], found.rows[row + 1] - found.rows[row]);
}

void BrickComponents::join_face(int64_t index, int axis, int64_t at, uint32_t to)
{
    for (int64_t b = 0; b < SIDE; ++b)
        for (int64_t a = 0; a < (axis == 0 ? SIDE : 1); ++a) {
            const int64_t y = axis == 0 ? a : axis == 1 ? at : b, z = axis == 2 ? at : b;
            const size_t row = size_t(y + SIDE * z);
            for (const Run& run : runs(index, row))
                if (axis != 0 || (run.first <= at && at <= run.last)) forest_.join(run.label, to);
        }
}

}  // namespace shvr
