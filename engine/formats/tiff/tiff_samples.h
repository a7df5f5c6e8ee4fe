#pragma once
// Converts the samples in a TIFF's blocks to voxels. Any thread may call these.

#include <span>

#include "engine/formats/tiff/tiff_layout.h"

namespace shvr {

/// The part of the pages that a volume uses, and the conversion of its samples to voxels.
struct TiffRecipe {
    VoxelType type = VoxelType::uint8;
    int sample = 0;          ///< index within the pixel
    int palette_color = -1;  ///< 0 to 2: colour of the palette (red, green, blue); -1: the samples themselves
    bool palette_has_8_bits = false;
    uint64_t exchanged_bits = 0;  ///< XORed into each voxel, to invert black and white or to subtract ImageJ's 32768
    bool mirrors_x = false;       ///< the page's first column is the right side of the picture
    bool mirrors_y = false;
};

/// Whether rows can be copied: a block's row equals a row of voxels, apart from byte order and `exchanged_bits`.
bool is_plain(const TiffLayout& layout, const TiffRecipe& recipe);

/// Returns the 2^bits entries of one colour of the page's palette; fails if the page has no palette.
std::vector<uint16_t> palette_of(const TiffPage& page, const TiffLayout& layout, int color);
/// Whether each entry is an 8-bit value v widened to 16 bits, as v * 257 (the byte twice) or v * 256.
bool has_8_bits(const std::vector<uint16_t>& palette);

/// Fills `voxels` with the pixels of a block's row, beginning with pixel `first`, in native byte order.
void unpack_row(const TiffLayout& layout, const TiffRecipe& recipe, const std::vector<uint16_t>& palette,
                std::span<const std::byte> row, int64_t first, std::span<std::byte> voxels);

void exchange_bits(const TiffRecipe& recipe, std::span<std::byte> voxels);
/// Mirrors rows of `width` voxels along x, y, both or neither, as `recipe` says.
void mirror(const TiffRecipe& recipe, int64_t width, std::span<std::byte> voxels);

}  // namespace shvr
