#pragma once
// The content and storage of one page: size, samples, compression, and its blocks (strips or tiles). All that a page
// states about its blocks is checked against the file before memory is allocated for them. Any thread may call these
// functions; a TiffPage belongs to one thread at a time.

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
    std::vector<int> extra_samples{};  ///< EXTRASAMPLE_..., one for each sample after the colour samples

    // Its storage
    int compression = 1;  ///< COMPRESSION_...
    bool is_lsb_first = false;
    bool is_planar = false;  ///< each block holds only one sample of each of its pixels
    bool is_tiled = false;
    int64_t block_width = 0, block_height = 0;

    int64_t blocks_across() const { return (width + block_width - 1) / block_width; }
    int64_t blocks_down() const { return (height + block_height - 1) / block_height; }
    int64_t blocks() const { return blocks_across() * blocks_down() * (is_planar ? samples : 1); }
    int block_samples() const { return is_planar ? 1 : samples; }
    int64_t block_row_bytes() const { return (block_width * block_samples() * bits + 7) / 8; }
    /// Number of rows in a block: the last strip of a page ends with the page, but tiles always have all their rows.
    int64_t rows_of_block(int64_t row_of_blocks) const;
    /// Uncompressed size.
    int64_t page_bytes() const;

    /// Whether the file's bytes are the samples themselves, apart from their byte order.
    bool is_bare() const { return compression == 1 && !is_lsb_first; }
};

/// Returns the layout that the page states; fails only if it cannot be a picture.
TiffLayout layout_of(const TiffPage& page);
/// Whether pages with these layouts can be slices of one volume.
bool show_the_same(const TiffLayout& a, const TiffLayout& b);
/// Describes a layout, as in "512x512 pixels of uint16" or "512x512 pixels of 3 samples of 8 bits".
std::string in_words(const TiffLayout& layout);

/// No voxel type holds 64-bit integers, so their bits are read as float64.
StoredNumber stored_number_of(const TiffLayout& layout);
/// Returns the voxel type that holds the samples, or at least their bits, exactly; null if there is none.
std::optional<VoxelType> voxel_type_of(const TiffLayout& layout);

/// Fails if the page's kind of picture or its compression is not supported; the message states what is expected.
void check_is_supported(const TiffPage& page, const TiffLayout& layout);

/// The position of a block in the file. Fails if it is outside the file, or too short for the block.
struct TiffExtent {
    int64_t offset = 0;
    int64_t bytes = 0;
};
TiffExtent extent_of_block(const TiffFile& file, const TiffPage& page, const TiffLayout& layout, int64_t block);
/// Checks all blocks of a page, and that no two of them overlap.
void check_blocks(const TiffFile& file, const TiffPage& page, const TiffLayout& layout);
/// Fails if a file of the given size cannot contain `pages` pages with this layout.
void check_amount(const TiffFile& file, const TiffLayout& layout, int64_t pages);
/// Returns the maximum memory that libtiff may allocate at once to decode blocks of a page with this layout.
int64_t decoding_memory(const TiffFile& file, const TiffLayout& layout);

}  // namespace shvr
