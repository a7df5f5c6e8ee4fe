#include "engine/components/bit_slab.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/volume/grid.h"
#include "shaders/bricks.h"

namespace shvr {
namespace {

/// Voxels are read in parts of at most this size, a core's L2 cache, unless a single block of the source is larger.
constexpr int64_t STRIP_BYTES = int64_t{1} << 20;
constexpr int64_t MAX_BIT_BYTES = int64_t{64} << 20;
constexpr int64_t WORD = 64;

/// Returns the columns of the run of adjacent blocks that starts with `block`, and moves `block` past that run.
template <class Block>
BitLayout::Columns touching(Block& block, Block end, const StoredBlocks& stored, int64_t width)
{
    const Block first = block;
    while (++block != end && block->z == first->z && block->y == first->y && block->x == (block - 1)->x + 1) continue;
    return {first->x * stored.block.x, std::min(width, ((block - 1)->x + int64_t{1}) * stored.block.x)};
}

}  // namespace

BitLayout::BitLayout(const Size3& size, const std::optional<StoredBlocks>& stored)
{
    if (!stored) {
        layers_.push_back({.upper = size.z, .strips = {{.upper = size.y, .columns = {{0, size.x}}}}});
    } else {
        for (auto block = stored->blocks.begin(); block != stored->blocks.end();) {
            const int64_t z = block->z * stored->block.z, y = block->y * stored->block.y;
            if (layers_.empty() || layers_.back().lower != z)
                layers_.push_back({.lower = z, .upper = std::min(size.z, z + stored->block.z)});
            std::vector<Strip>& strips = layers_.back().strips;
            if (strips.empty() || strips.back().lower != y)
                strips.push_back({.lower = y, .upper = std::min(size.y, y + stored->block.y)});
            strips.back().columns.push_back(touching(block, stored->blocks.end(), *stored, size.x));
        }
    }
    for (Layer& layer : layers_) {
        for (const Strip& strip : layer.strips)
            for (const Columns& columns : strip.columns)
                layer.words += (strip.upper - strip.lower) * words_of_row(columns.upper - columns.lower);
        words_ += layer.words * (layer.upper - layer.lower);
    }
}

const BitLayout::Layer* BitLayout::layer_from(int64_t z) const
{
    const auto found = std::ranges::upper_bound(layers_, z, {}, &Layer::upper);
    return found == layers_.end() ? nullptr : &*found;
}

BitSlab::BitSlab(const VolumeSource& source, const ThresholdBits& bits, const BitLayout& layout)
    : source_(source), bits_(bits), layout_(layout), block_(glm::min(source.block(), source.info().size))
{}

int64_t BitSlab::thickness_of(const BitLayout::Layer& layer) const
{
    const int64_t thickness = std::clamp<int64_t>(MAX_BIT_BYTES / (8 * layer.words), 1, block_.z);
    // If blocks are thin and slices small, the slab spans several blocks along z, to keep reads large.
    const int64_t bytes = layer.words * WORD * int64_t(bytes_of(bits_.type()));
    return thickness < block_.z ? thickness : thickness * std::max<int64_t>(STRIP_BYTES / (bytes * thickness), 1);
}

bool BitSlab::read(int64_t z, int64_t end)
{
    const BitLayout::Layer* const next = layout_.layer_from(z);
    if (next == nullptr || std::max(z, next->lower) >= end) return false;  // the present slab stays as it is
    const BitLayout::Layer* const layer = std::exchange(layer_, next);
    const int64_t lower = std::exchange(lower_, std::max(z, layer_->lower));
    if (layer == layer_ && upper_ == lower_)
        before_.assign(words_.begin() + (upper_ - 1 - lower) * layer_->words,
                       words_.begin() + (upper_ - lower) * layer_->words);
    else
        before_.clear();
    upper_ = std::min({end, layer_->upper, lower_ + thickness_of(*layer_)});
    words_.assign(size_t(words()), 0);
    int64_t word = 0;
    for (const BitLayout::Strip& strip : layer_->strips) {
        read_strip(strip, word);
        for (const BitLayout::Columns& columns : strip.columns)
            word += (strip.upper - strip.lower) * words_of_row(columns.upper - columns.lower);
    }
    return true;
}

/// Fills the bits of a strip. `first_word`: index, within each slice, of the first word of the strip's first row.
void BitSlab::read_strip(const BitLayout::Strip& strip, int64_t first_word)
{
    const auto voxel_bytes = int64_t(bytes_of(bits_.type()));
    const int64_t slices = upper_ - lower_;
    const int64_t words_of_rows = words_of_strip(strip);
    int64_t word_of_columns = first_word;
    for (const BitLayout::Columns& columns : strip.columns) {
        const int64_t width = columns.upper - columns.lower;
        // Reads as many whole rows of blocks at once as the limit allows or, if not even one, parts of a row of blocks.
        const int64_t least_bytes = voxel_bytes * block_.y * slices;
        int64_t step = width;
        if (width * least_bytes > STRIP_BYTES) {
            const int64_t unit = std::lcm(block_.x, WORD);
            step = std::max<int64_t>(STRIP_BYTES / least_bytes / unit, 1) * unit;
        }
        const int64_t rows =
            std::max<int64_t>(STRIP_BYTES / (std::min(step, width) * voxel_bytes * slices) / block_.y, 1) * block_.y;
        for (int64_t y = strip.lower; y < strip.upper; y += rows)
            for (int64_t x = columns.lower; x < columns.upper; x += step)
                read_part(
                    {{x, y, lower_}, {std::min(columns.upper, x + step), std::min(strip.upper, y + rows), upper_}},
                    word_of_columns + (y - strip.lower) * words_of_rows + (x - columns.lower) / WORD, words_of_rows);
        word_of_columns += words_of_row(width);
    }
}

/// Returns the columns of `part`, in whole words, that can hold voxels at or above the threshold; null if none can.
std::optional<BitLayout::Columns> BitSlab::columns_above(const VoxelBox& part) const
{
    const int64_t begin = part.lower.x, end = part.upper.x;
    // The known range of a float brick excludes infinities, but an infinite voxel can still be above the threshold.
    if (is_float(bits_.type())) return BitLayout::Columns{begin, end};
    const Size3 first = part.lower / BRICK_SIDE, last = (part.upper - int64_t{1}) / BRICK_SIDE;
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
    if (lower == upper) return std::nullopt;
    return BitLayout::Columns{begin + std::max<int64_t>(lower * BRICK_SIDE - begin, 0) / WORD * WORD,
                              std::min(end, begin + words_of_row(upper * BRICK_SIDE - begin) * WORD)};
}

/// Fills the bits of a part. `first_word`: index of its first word within each slice; `words_of_rows`: words per row.
void BitSlab::read_part(const VoxelBox& part, int64_t first_word, int64_t words_of_rows)
{
    const std::optional<BitLayout::Columns> columns = columns_above(part);
    if (!columns) return;
    const int64_t width = columns->upper - columns->lower, rows = part.size().y;
    const size_t row_bytes = size_t(width) * bytes_of(bits_.type());
    voxels_.resize(row_bytes * size_t(rows * part.size().z));
    source_.read({{columns->lower, part.lower.y, part.lower.z}, {columns->upper, part.upper.y, part.upper.z}}, voxels_);
    first_word += (columns->lower - part.lower.x) / WORD;
    const std::byte* voxels = voxels_.data();
    for (int64_t slice = 0; slice < part.size().z; ++slice)
        for (int64_t row = 0; row < rows; ++row, voxels += row_bytes) {
            const int64_t word = slice * layer_->words + first_word + row * words_of_rows;
            bits_.convert({voxels, row_bytes}, std::span(words_).subspan(size_t(word), size_t(words_of_row(width))));
        }
}

}  // namespace shvr
