#pragma once
// The content and storage of one page: size, samples, compression, and its blocks (strips or tiles). Everything a page
// states about its blocks is checked against the file before memory is allocated for them. Any thread may call these; a
// TiffPage belongs to one thread at a time.

#include "engine/formats/stored_numbers.h"
#include "engine/formats/tiff/tiff_page.h"
#include "engine/volume/volume.h"

namespace shvr {

struct TiffLayout {
    // The picture
    int64_t width = 0, height = 0;
    int bits = 1;                      ///< per sample
    int sample_format = 1;             ///< SAMPLEFORMAT_...
    int samples = 1;                   ///< per pixel
    int photometric = 1;               ///< PHOTOMETRIC_...
    int orientation = 1;               ///< ORIENTATION_...
    std::vector<int> extra_samples{};  ///< EXTRASAMPLE_..., one for each sample beyond the colour

    // Its storage
    int compression = 1;  ///< COMPRESSION_...
    bool is_lsb_first = false;
    bool is_planar = false;  ///< each block holds one sample of its pixels
    bool is_tiled = false;
    int64_t block_width = 0, block_height = 0;

    int64_t blocks_across() const { return (width + block_width - 1) / block_width; }
    int64_t blocks_down() const { return (height + block_height - 1) / block_height; }
    int64_t blocks() const { return blocks_across() * blocks_down() * (is_planar ? samples : 1); }
    int block_samples() const { return is_planar ? 1 : samples; }
    int64_t block_row_bytes() const { return (block_width * block_samples() * bits + 7) / 8; }
    /// Number of rows in a block: strips end with the page, tiles do not.
    int64_t rows_of_block(int64_t row_of_blocks) const;
    /// Uncompressed size.
    int64_t page_bytes() const;

    /// Whether the file's bytes are the samples, except for their byte order.
    bool is_bare() const { return compression == 1 && !is_lsb_first; }
};

/// The layout that the page states; fails only if it cannot be a picture.
TiffLayout layout_of(const TiffPage& page);
/// Whether pages with these layouts can be slices of one volume.
bool show_the_same(const TiffLayout& a, const TiffLayout& b);
/// "512x512 pixels of uint16", "512x512 pixels of 3 samples of 8 bits".
std::string in_words(const TiffLayout& layout);

/// Integers of 64 bits are no voxel type: their bits are read as float64.
StoredNumber stored_number_of(const TiffLayout& layout);
/// The type that holds the samples exactly, or their bits; null if there is none.
std::optional<VoxelType> voxel_type_of(const TiffLayout& layout);

/// Fails, stating what is expected instead, if the page's kind of picture or its compression is not supported.
void check_is_supported(const TiffPage& page, const TiffLayout& layout);

/// Where a block is in the file. Fails if that is outside the file, or too short for the block.
struct TiffExtent {
    int64_t offset = 0;
    int64_t bytes = 0;
};
TiffExtent extent_of_block(const TiffFile& file, const TiffPage& page, const TiffLayout& layout, int64_t block);
/// Checks all blocks of a page, and that none overlap.
void check_blocks(const TiffFile& file, const TiffPage& page, const TiffLayout& layout);
/// Fails if a file of that size cannot contain `pages` such pages.
void check_amount(const TiffFile& file, const TiffLayout& layout, int64_t pages);
/// Maximum memory that libtiff may allocate at once to decode blocks of such a page.
int64_t decoding_memory(const TiffFile& file, const TiffLayout& layout);

}  // namespace shvr
