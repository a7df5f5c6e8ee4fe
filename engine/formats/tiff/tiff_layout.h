#pragma once
// The content and storage of one page: its size, samples, compression and blocks (strips or tiles). Statements about
// blocks are checked against the file before memory is allocated for them. Any thread may call these functions, but
// each TiffPage must be used by one thread at a time.

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
    std::vector<int> extra_samples{};  ///< EXTRASAMPLE_..., one for each sample after the colours

    // Its storage
    int compression = 1;  ///< COMPRESSION_...
    bool is_lsb_first = false;
    bool is_planar = false;  ///< each block holds one sample per pixel (planar configuration)
    bool is_tiled = false;
    int64_t block_width = 0, block_height = 0;

    int64_t blocks_across() const { return (width + block_width - 1) / block_width; }
    int64_t blocks_down() const { return (height + block_height - 1) / block_height; }
    int64_t blocks() const { return blocks_across() * blocks_down() * (is_planar ? samples : 1); }
    int block_samples() const { return is_planar ? 1 : samples; }
    int64_t block_row_bytes() const { return (block_width * block_samples() * bits + 7) / 8; }
    /// Returns the number of rows in a block: a page's last strip may be shorter, but tiles always have all their rows.
    int64_t rows_of_block(int64_t row_of_blocks) const;
    /// Uncompressed size.
    int64_t page_bytes() const;

    /// Whether the file's bytes are the samples themselves, apart from their byte order.
    bool is_bare() const { return compression == 1 && !is_lsb_first; }
};

/// Returns the layout that the page states. Fails only if a page with that layout cannot be a picture.
TiffLayout layout_of(const TiffPage& page);
/// Whether pages with these layouts can be slices of one volume.
bool show_the_same(const TiffLayout& a, const TiffLayout& b);
/// Describes a layout, as in "512x512 pixels of uint16" or "512x512 pixels of 3 samples of 8 bits".
std::string in_words(const TiffLayout& layout);

/// Returns the kind of numbers that need conversion: 64-bit integers, whose bits are read as float64; else `plain`.
StoredNumber stored_number_of(const TiffLayout& layout);
/// Returns the voxel type that holds the samples exactly or, if they need conversion, their raw bits; null if none.
std::optional<VoxelType> voxel_type_of(const TiffLayout& layout);

/// Fails if the kind of picture or its compression is not supported; the message states the supported ones.
void check_is_supported(const TiffPage& page, const TiffLayout& layout);

/// The position of a block in the file. extent_of_block() fails if it is outside the file, or too short for the block.
struct TiffExtent {
    int64_t offset = 0;
    int64_t bytes = 0;
};
TiffExtent extent_of_block(const TiffFile& file, const TiffPage& page, const TiffLayout& layout, int64_t block);
/// Checks every block of a page, and that blocks do not overlap.
void check_blocks(const TiffFile& file, const TiffPage& page, const TiffLayout& layout);
/// Fails if a file of this size cannot hold `pages` pages with this layout.
void check_amount(const TiffFile& file, const TiffLayout& layout, int64_t pages);
/// Returns the most memory that libtiff may allocate at once to decode a block of a page with this layout.
int64_t decoding_memory(const TiffFile& file, const TiffLayout& layout);

}  // namespace shvr
