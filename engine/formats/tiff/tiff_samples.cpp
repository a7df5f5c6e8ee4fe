#include "engine/formats/tiff/tiff_samples.h"

#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/base/error.h"

namespace shvr {
namespace {

/// Returns sample `index` of a row of samples of `bits` bits each, packed without gaps, highest bit first.
uint32_t packed_sample(std::span<const std::byte> row, int64_t index, int bits)
{
    const int64_t first_bit = index * bits;
    uint32_t taken = 0;
    int have = 0;
    for (auto at = size_t(first_bit / 8); have < bits + first_bit % 8; ++at, have += 8) {
        taken = taken << 8 | std::to_integer<uint32_t>(row[at]);
    }
    return taken >> (have - first_bit % 8 - bits) & ((uint32_t{1} << bits) - 1);
}

template <class Voxel, class Value>
void store_each(std::span<std::byte> voxels, const Value& value)
{
    const size_t count = voxels.size() / sizeof(Voxel);
    for (size_t i = 0; i < count; ++i) {
        const auto voxel = static_cast<Voxel>(value(int64_t(i)));
        std::memcpy(voxels.data() + i * sizeof(Voxel), &voxel, sizeof(Voxel));
    }
}

/// Takes every `step`-th element of `row`, beginning with element `first`.
template <class Bits>
void gather(std::span<const std::byte> row, int64_t first, int64_t step, std::span<std::byte> voxels)
{
    const std::byte* from = row.data() + size_t(first) * sizeof(Bits);
    for (size_t at = 0; at < voxels.size(); at += sizeof(Bits), from += size_t(step) * sizeof(Bits)) {
        std::memcpy(voxels.data() + at, from, sizeof(Bits));
    }
}

template <class Bits>
void exchange_each(uint64_t exchanged, std::span<std::byte> voxels)
{
    for (size_t at = 0; at < voxels.size(); at += sizeof(Bits)) {
        Bits bits;
        std::memcpy(&bits, voxels.data() + at, sizeof(Bits));
        bits = static_cast<Bits>(bits ^ static_cast<Bits>(exchanged));
        std::memcpy(voxels.data() + at, &bits, sizeof(Bits));
    }
}

bool is_half(const TiffLayout& layout)
{
    return layout.sample_format == SAMPLEFORMAT_IEEEFP && layout.bits == 16;
}

bool is_whole_bytes(const TiffLayout& layout)
{
    return layout.bits == 8 || layout.bits == 16 || layout.bits == 32 || layout.bits == 64;
}

}  // namespace

bool is_plain(const TiffLayout& layout, const TiffRecipe& recipe)
{
    return layout.block_samples() == 1 && recipe.palette_color < 0 && is_whole_bytes(layout) && !is_half(layout);
}

std::vector<uint16_t> palette_of(const TiffPage& page, const TiffLayout& layout, int color)
{
    uint16_t* colors[3] = {};
    if (TIFFGetField(page.handle(), TIFFTAG_COLORMAP, &colors[0], &colors[1], &colors[2]) != 1 ||
        colors[color] == nullptr) {
        fail(page.subject(), ": has no ColorMap; expected a palette of ", 1 << layout.bits, " colours");
    }
    const size_t entries = size_t{1} << layout.bits;
    std::vector<uint16_t> palette(colors[color], colors[color] + entries);
    // Some programs write 8-bit values into the 16-bit entries. Such palettes are scaled up, as in libtiff's tools.
    const auto is_byte = [](uint16_t entry) { return entry <= 255; };
    const bool are_bytes = std::all_of(colors, colors + 3, [&](const uint16_t* of_color) {
        return of_color != nullptr && std::all_of(of_color, of_color + entries, is_byte);
    });
    for (uint16_t& entry : palette)
        if (are_bytes) entry = uint16_t(entry * 257);
    return palette;
}

bool has_8_bits(const std::vector<uint16_t>& palette)
{
    return std::all_of(palette.begin(), palette.end(),
                       [](uint16_t entry) { return (entry & 255) == 0 || (entry & 255) == entry >> 8; });
}

void unpack_row(const TiffLayout& layout, const TiffRecipe& recipe, const std::vector<uint16_t>& palette,
                std::span<const std::byte> row, int64_t first, std::span<std::byte> voxels)
{
    const int64_t step = layout.block_samples();
    const int64_t start = first * step + (layout.is_planar ? 0 : recipe.sample);
    if (recipe.palette_color >= 0) {
        const int shift = recipe.palette_has_8_bits ? 8 : 0;
        const auto color = [&](int64_t i) {
            uint16_t whole = 0;
            if (layout.bits == 16) std::memcpy(&whole, row.data() + 2 * (start + i * step), sizeof(whole));
            const uint32_t index = layout.bits == 16 ? whole : packed_sample(row, start + i * step, layout.bits);
            return palette[index] >> shift;
        };
        return recipe.palette_has_8_bits ? store_each<uint8_t>(voxels, color) : store_each<uint16_t>(voxels, color);
    }
    if (is_half(layout)) {
        return store_each<float>(voxels, [&](int64_t i) {
            uint16_t half = 0;
            std::memcpy(&half, row.data() + 2 * (start + i * step), sizeof(half));
            return float_of_half(half);
        });
    }
    if (!is_whole_bytes(layout)) {
        const auto sample = [&](int64_t i) { return packed_sample(row, start + i * step, layout.bits); };
        return layout.bits < 8 ? store_each<uint8_t>(voxels, sample) : store_each<uint16_t>(voxels, sample);
    }
    if (step == 1) {
        std::memcpy(voxels.data(), row.data() + start * layout.bits / 8, voxels.size());
        return;
    }
    if (layout.bits == 8) gather<uint8_t>(row, start, step, voxels);
    if (layout.bits == 16) gather<uint16_t>(row, start, step, voxels);
    if (layout.bits == 32) gather<uint32_t>(row, start, step, voxels);
    if (layout.bits == 64) gather<uint64_t>(row, start, step, voxels);
}

void exchange_bits(const TiffRecipe& recipe, std::span<std::byte> voxels)
{
    if (recipe.exchanged_bits == 0) return;
    switch (bytes_of(recipe.type)) {
        case 1: return exchange_each<uint8_t>(recipe.exchanged_bits, voxels);
        case 2: return exchange_each<uint16_t>(recipe.exchanged_bits, voxels);
        case 8: return exchange_each<uint64_t>(recipe.exchanged_bits, voxels);
        default: return exchange_each<uint32_t>(recipe.exchanged_bits, voxels);
    }
}

void mirror(const TiffRecipe& recipe, int64_t width, std::span<std::byte> voxels)
{
    const size_t voxel_bytes = bytes_of(recipe.type);
    const size_t row_bytes = size_t(width) * voxel_bytes;
    const size_t rows = voxels.size() / row_bytes;
    if (recipe.mirrors_y) {
        for (size_t row = 0; row < rows / 2; ++row) {
            std::swap_ranges(voxels.data() + row * row_bytes, voxels.data() + (row + 1) * row_bytes,
                             voxels.data() + (rows - 1 - row) * row_bytes);
        }
    }
    if (!recipe.mirrors_x) return;
    for (size_t row = 0; row < rows; ++row) {
        std::byte* const begin = voxels.data() + row * row_bytes;
        for (size_t i = 0; i < size_t(width) / 2; ++i) {
            std::swap_ranges(begin + i * voxel_bytes, begin + (i + 1) * voxel_bytes,
                             begin + (size_t(width) - 1 - i) * voxel_bytes);
        }
    }
}

}  // namespace shvr
