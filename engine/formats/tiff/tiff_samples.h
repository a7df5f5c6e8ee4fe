#pragma once
// From samples, as the blocks of a TIFF hold them, to voxels. Any thread may call these.

#include <span>

#include "engine/formats/tiff/tiff_layout.h"

namespace shvr {

/// What a volume takes from its pages, and what it makes of it.
struct TiffRecipe {
    VoxelType type = VoxelType::uint8;
    int sample = 0;          ///< which one of a pixel's
    int palette_color = -1;  ///< 0 to 2: red, green or blue of the palette, -1: the samples themselves
    bool palette_has_8_bits = false;
    uint64_t exchanged_bits = 0;  ///< of each voxel; turns white into black, and takes ImageJ's 32768 off
    bool mirrors_x = false;       ///< the page's first column is the picture's right side
    bool mirrors_y = false;
};

/// Whether a row of voxels is a row of the block, byte for byte (but for byte order and `exchanged_bits`).
bool is_plain(const TiffLayout& layout, const TiffRecipe& recipe);

/// 2^bits entries of one colour of the page's palette; fails where it has none.
std::vector<uint16_t> palette_of(const TiffPage& page, const TiffLayout& layout, int color);
/// Whether entries are 8-bit values written twice, v * 257, or v * 256.
bool has_8_bits(const std::vector<uint16_t>& palette);

/// `voxels` gets the pixels from `first` on of one row of a block, in native byte order.
void unpack_row(const TiffLayout& layout, const TiffRecipe& recipe, const std::vector<uint16_t>& palette,
                std::span<const std::byte> row, int64_t first, std::span<std::byte> voxels);

void exchange_bits(const TiffRecipe& recipe, std::span<std::byte> voxels);
/// Turns rows of `width` voxels end to end, and their order.
void mirror(const TiffRecipe& recipe, int64_t width, std::span<std::byte> voxels);

}  // namespace shvr
