#include "engine/components/bit_slab.h"

#include <algorithm>

#include "engine/volume/grid.h"
#include "shaders/bricks.h"

namespace shvr {
namespace {

/// Bytes of voxels read at once, unless a row of blocks is larger: the size of a core's second-level cache.
constexpr int64_t STRIP_BYTES = int64_t{1} << 20;
constexpr int64_t MAX_BIT_BYTES = int64_t{64} << 20;

}  // namespace

BitSlab::BitSlab(const VolumeSource& source, const ThresholdBits& bits)
    : source_(source), bits_(bits), size_(source.info().size), row_words_(words_of_row(size_.x))
{
    const Size3 block = glm::min(source.block(), size_);
    const int64_t row_bytes = size_.x * int64_t(bytes_of(source.info().type));
    const int64_t bit_bytes = row_words_ * size_.y * 8;
    slices_ = std::clamp<int64_t>(MAX_BIT_BYTES / bit_bytes, 1, block.z);
    rows_ = std::max<int64_t>(STRIP_BYTES / (row_bytes * slices_) / block.y, 1) * block.y;
    if (rows_ >= size_.y) {
        rows_ = size_.y;
        slices_ *= std::max<int64_t>(STRIP_BYTES / (row_bytes * rows_ * slices_), 1);
    }
    slices_ = std::min(slices_, size_.z);
}

void BitSlab::read(int64_t lower, int64_t upper)
{
    words_.resize(size_t(row_words_ * size_.y * slices_));
    for (int64_t y = 0; y < size_.y; y += rows_) read_rows(lower, upper, y, std::min(size_.y, y + rows_));
}

/// The columns that can hold a voxel at or above the threshold: whole words, and all of them inside the volume.
std::pair<int64_t, int64_t> BitSlab::columns_above(const VoxelBox& strip) const
{
    // Infinities can be above the threshold, but ranges leave them out.
    if (is_float(bits_.type())) return {0, size_.x};
    const Size3 first = strip.lower / BRICK_SIDE, last = (strip.upper - int64_t{1}) / BRICK_SIDE;
    const auto is_above = [&](int64_t x) {
        for (int64_t z = first.z; z <= last.z; ++z)
            for (int64_t y = first.y; y <= last.y; ++y) {
                const std::optional<ValueRange> range = source_.brick_range(0, {x, y, z});
                if (!range || bits_.reaches(*range)) return true;
            }
        return false;
    };
    int64_t lower = first.x, upper = last.x + 1;
    while (lower < upper && !is_above(lower)) ++lower;
    while (lower < upper && !is_above(upper - 1)) --upper;
    if (lower == upper) return {0, 0};
    return {lower * BRICK_SIDE / 64 * 64, std::min(size_.x, words_of_row(upper * BRICK_SIDE) * 64)};
}

void BitSlab::read_rows(int64_t lower, int64_t upper, int64_t lower_row, int64_t upper_row)
{
    const auto [left, right] = columns_above({{0, lower_row, lower}, {size_.x, upper_row, upper}});
    const int64_t rows = upper_row - lower_row;
    const auto row_of = [&](int64_t slice, int64_t row) {
        return std::span(words_).subspan(size_t((lower_row + row + slice * size_.y) * row_words_), size_t(row_words_));
    };
    const size_t row_bytes = size_t(std::max<int64_t>(right - left, 0)) * bytes_of(bits_.type());
    if (row_bytes > 0) {
        voxels_.resize(row_bytes * size_t(rows * (upper - lower)));
        source_.read({{left, lower_row, lower}, {right, upper_row, upper}}, voxels_);
    }
    for (int64_t slice = 0; slice < upper - lower; ++slice)
        for (int64_t row = 0; row < rows; ++row) {
            const std::span<uint64_t> words = row_of(slice, row);
            std::ranges::fill(words, uint64_t{0});
            if (row_bytes == 0) continue;
            bits_.convert(std::span(voxels_).subspan(size_t(row + rows * slice) * row_bytes, row_bytes),
                          words.subspan(size_t(left / 64), size_t(words_of_row(right - left))));
        }
}

}  // namespace shvr
