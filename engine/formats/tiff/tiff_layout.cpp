#include "engine/formats/tiff/tiff_layout.h"

#include <tiffio.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

/// Maximum size of a compressed block after decoding; a block is always decoded as a whole.
constexpr int64_t MAX_BLOCK_BYTES = int64_t{1} << 31;

struct Compression {
    int scheme;
    const char* name;
    /// Maximum number of bytes that one byte can decode to, rounded up. 0: not limited by bytes, but one bit decodes to
    /// at most one row (fax). UNBOUNDED: no limit, since the format encodes whole areas of one colour.
    int64_t largest_ratio;
    bool is_read;
};

constexpr int64_t UNBOUNDED = int64_t{1} << 40;
constexpr Compression COMPRESSIONS[] = {
    {COMPRESSION_NONE, "none", 1, true},
    {COMPRESSION_CCITTRLE, "CCITT RLE", 0, true},
    {COMPRESSION_CCITTFAX3, "CCITT group 3", 0, true},
    {COMPRESSION_CCITTFAX4, "CCITT group 4", 0, true},
    {COMPRESSION_CCITTRLEW, "CCITT RLE", 0, true},
    {COMPRESSION_LZW, "LZW", 4096, true},                // 9 bits decode to at most 4093 bytes
    {COMPRESSION_JPEG, "JPEG", 4096, true},              // each of the few scans takes at least a bit per 64 samples
    {COMPRESSION_ADOBE_DEFLATE, "Deflate", 1032, true},  // 2 bits decode to 258 bytes
    {COMPRESSION_DEFLATE, "Deflate", 1032, true},
    {COMPRESSION_PACKBITS, "PackBits", 64, true},  // 2 bytes decode to at most 128
    {COMPRESSION_LZMA, "LZMA", 16384, true},       // rounded up from 6900, measured on zeros
    {COMPRESSION_ZSTD, "Zstandard", 65536, true},  // at least 4 bytes encode a block of 128 KiB
    {COMPRESSION_WEBP, "WebP", UNBOUNDED, true},
    {COMPRESSION_OJPEG, "old-style JPEG", 1, false},
    {COMPRESSION_SGILOG, "LogLuv", 1, false},
    {COMPRESSION_SGILOG24, "LogLuv", 1, false},
    {COMPRESSION_PIXARLOG, "PixarLog", 1, false},
    {COMPRESSION_JBIG, "JBIG", 1, false},
    {COMPRESSION_JP2000, "JPEG 2000", 1, false},
    {33003, "JPEG 2000", 1, false},  // Aperio's slide scanners
    {33005, "JPEG 2000", 1, false},
    {COMPRESSION_LERC, "LERC", 1, false},
    {COMPRESSION_JXL, "JPEG XL", 1, false},
};

const Compression* find_compression(int scheme)
{
    const auto* const found = std::find_if(std::begin(COMPRESSIONS), std::end(COMPRESSIONS),
                                           [&](const Compression& known) { return known.scheme == scheme; });
    return found == std::end(COMPRESSIONS) ? nullptr : found;
}

/// Returns the maximum number of bytes that `bytes` bytes of the file can decode to.
int64_t most_decoded(const TiffLayout& layout, int64_t bytes)
{
    const Compression* const known = find_compression(layout.compression);
    const int64_t ratio = known == nullptr ? 1 : known->largest_ratio;
    if (ratio == 1) return bytes;
    int64_t most = 0;
    const int64_t factor = ratio > 0 ? ratio : 8 * layout.block_row_bytes();
    if (__builtin_mul_overflow(bytes, factor, &most)) return INT64_MAX;
    return most;
}

const char* name_of_block(const TiffLayout& layout)
{
    return layout.is_tiled ? "tile " : "strip ";
}

const char* name_of_byte_counts(const TiffLayout& layout)
{
    return layout.is_tiled ? "TileByteCounts" : "StripByteCounts";
}

int64_t checked_side(const TiffPage& page, const char* name, uint32_t side)
{
    if (side < 1 || side > MAX_SIDE) {
        fail(page.subject(), ": ", name, " is ", side, "; expected 1 to ", MAX_SIDE);
    }
    return side;
}

}  // namespace

int64_t TiffLayout::rows_of_block(int64_t row_of_blocks) const
{
    return is_tiled ? block_height : std::min(block_height, height - row_of_blocks * block_height);
}

int64_t TiffLayout::page_bytes() const
{
    const int64_t rows = is_tiled ? blocks_down() * block_height : height;
    return blocks_across() * block_row_bytes() * rows * (is_planar ? samples : 1);
}

TiffLayout layout_of(const TiffPage& page)
{
    TiffLayout layout;
    layout.width = checked_side(page, "ImageWidth", page.number32(TIFFTAG_IMAGEWIDTH, 0));
    layout.height = checked_side(page, "ImageLength", page.number32(TIFFTAG_IMAGELENGTH, 0));
    layout.bits = page.number16(TIFFTAG_BITSPERSAMPLE, 1);
    layout.sample_format = page.number16(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    layout.samples = page.number16(TIFFTAG_SAMPLESPERPIXEL, 1);
    layout.photometric = page.number16(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    layout.orientation = page.number16(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    layout.compression = page.number16(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    layout.is_lsb_first = page.number16(TIFFTAG_FILLORDER, FILLORDER_MSB2LSB) == FILLORDER_LSB2MSB;
    layout.is_planar =
        layout.samples > 1 && page.number16(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE;
    if (layout.samples < 1 || layout.bits < 1 || layout.bits > 64) {
        fail(page.subject(), ": has ", layout.samples, " samples of ", layout.bits,
             " bits a pixel; expected at least 1, of 1 to 64 bits");
    }
    uint16_t count = 0;
    const uint16_t* extra = nullptr;
    if (TIFFGetField(page.handle(), TIFFTAG_EXTRASAMPLES, &count, &extra) == 1 && extra != nullptr) {
        layout.extra_samples.assign(extra, extra + count);
    }

    layout.is_tiled = TIFFIsTiled(page.handle()) != 0;
    if (layout.is_tiled) {
        layout.block_width = checked_side(page, "TileWidth", page.number32(TIFFTAG_TILEWIDTH, 0));
        layout.block_height = checked_side(page, "TileLength", page.number32(TIFFTAG_TILELENGTH, 0));
    } else {
        layout.block_width = layout.width;
        layout.block_height = std::min<int64_t>(layout.height, page.number32(TIFFTAG_ROWSPERSTRIP, UINT32_MAX));
        if (layout.block_height < 1) fail(page.subject(), ": RowsPerStrip is 0; expected at least 1");
    }
    return layout;
}

bool show_the_same(const TiffLayout& a, const TiffLayout& b)
{
    const auto meaning = [](const TiffLayout& layout) {
        return std::tie(layout.width, layout.height, layout.bits, layout.sample_format, layout.samples,
                        layout.photometric, layout.orientation, layout.extra_samples);
    };
    return meaning(a) == meaning(b);
}

std::string in_words(const TiffLayout& layout)
{
    const std::optional<VoxelType> type = voxel_type_of(layout);
    const StoredNumber number = stored_number_of(layout);
    const std::string sample = number != StoredNumber::plain ? name_of(number)
                               : type && bytes_of(*type) * 8 == size_t(layout.bits)
                                   ? name_of(*type)
                                   : sentence(layout.bits, " bit", layout.bits == 1 ? "" : "s",
                                              layout.sample_format == SAMPLEFORMAT_INT ? " with sign" : "");
    return sentence(layout.width, "x", layout.height, " pixels of ",
                    layout.samples > 1 ? sentence(layout.samples, " times ") : std::string(), sample);
}

StoredNumber stored_number_of(const TiffLayout& layout)
{
    if (layout.bits != 64 || layout.sample_format == SAMPLEFORMAT_IEEEFP) return StoredNumber::plain;
    return layout.sample_format == SAMPLEFORMAT_INT ? StoredNumber::int64 : StoredNumber::uint64;
}

std::optional<VoxelType> voxel_type_of(const TiffLayout& layout)
{
    const int bits = layout.bits;
    switch (layout.sample_format) {
        case SAMPLEFORMAT_UINT:
        case SAMPLEFORMAT_VOID:
            if (bits <= 8) return VoxelType::uint8;
            if (bits <= 16) return VoxelType::uint16;
            if (bits == 32) return VoxelType::uint32;
            if (bits == 64) return bits_type(StoredNumber::uint64);
            break;
        case SAMPLEFORMAT_INT:
            if (bits == 8) return VoxelType::int8;
            if (bits == 16) return VoxelType::int16;
            if (bits == 32) return VoxelType::int32;
            if (bits == 64) return bits_type(StoredNumber::int64);
            break;
        case SAMPLEFORMAT_IEEEFP:
            if (bits == 16 || bits == 32) return VoxelType::float32;
            if (bits == 64) return VoxelType::float64;
            break;
        default: break;
    }
    return {};
}

void check_is_supported(const TiffPage& page, const TiffLayout& layout)
{
    const Compression* const known = find_compression(layout.compression);
    if (known == nullptr || !known->is_read || TIFFIsCODECConfigured(uint16_t(layout.compression)) == 0) {
        fail(
            page.subject(), ": Compression is ", layout.compression,
            known == nullptr ? std::string() : sentence(" (", known->name, ")"),
            "; expected none, LZW, Deflate, PackBits, Zstandard, LZMA, JPEG, WebP or CCITT: save it again with one of ",
            "those, for example from Fiji");
    }
    if (!voxel_type_of(layout)) {
        const char* const kind = layout.sample_format == SAMPLEFORMAT_INT      ? "signed integers"
                                 : layout.sample_format == SAMPLEFORMAT_UINT   ? "unsigned integers"
                                 : layout.sample_format == SAMPLEFORMAT_IEEEFP ? "floats"
                                                                               : "numbers of unknown kind";
        fail(page.subject(), ": its samples are ", kind, " of ", layout.bits,
             " bits; expected integers of 8, 16, 32 or 64 bits, unsigned ones of 1 to 16 bits, or floats of 16, 32 or "
             "64 "
             "bits");
    }
    // In fax formats, one bit can decode to a whole row. To keep rows short, only one sample of 1 bit is accepted.
    if (known->largest_ratio == 0 && ((layout.samples != 1 && !layout.is_planar) || layout.bits != 1))
        fail(page.subject(), ": has ", layout.samples, " samples of ", layout.bits, " bits a pixel by ", known->name,
             "; expected one of 1 bit, as there is in a fax");
    const bool is_jpeg_color = layout.photometric == PHOTOMETRIC_YCBCR && layout.compression == COMPRESSION_JPEG;
    switch (layout.photometric) {
        case PHOTOMETRIC_MINISWHITE:
        case PHOTOMETRIC_MINISBLACK:
        case PHOTOMETRIC_RGB:
        case PHOTOMETRIC_PALETTE:
        case PHOTOMETRIC_MASK:
        case PHOTOMETRIC_SEPARATED: break;
        default:
            if (is_jpeg_color) break;
            fail(page.subject(), ": PhotometricInterpretation is ", layout.photometric,
                 layout.photometric == PHOTOMETRIC_YCBCR ? " (YCbCr without JPEG)"
                 : layout.photometric == PHOTOMETRIC_CFA ? " (a camera's raw image)"
                                                         : "",
                 "; expected grey, RGB, CMYK or a palette");
    }
    if (layout.photometric == PHOTOMETRIC_PALETTE && (layout.samples != 1 || layout.bits > 16)) {
        fail(page.subject(), ": has a palette for ", layout.samples, " samples of ", layout.bits,
             " bits; expected one, of at most 16");
    }
    if (layout.orientation > ORIENTATION_BOTLEFT || layout.orientation < ORIENTATION_TOPLEFT) {
        fail(page.subject(), ": Orientation is ", layout.orientation,
             ", rows and columns exchanged; expected 1 to 4: save it again without rotation");
    }
    const int64_t block_bytes = layout.block_row_bytes() * layout.rows_of_block(0);
    if (!layout.is_bare() && block_bytes > MAX_BLOCK_BYTES) {
        fail(page.subject(), ": has ", name_of_block(layout), "sizes of ", block_bytes,
             " bytes, compressed; expected at most ", MAX_BLOCK_BYTES);
    }
}

TiffExtent extent_of_block(const TiffFile& file, const TiffPage& page, const TiffLayout& layout, int64_t block)
{
    const auto index = uint32_t(block);
    const uint64_t offset = TIFFGetStrileOffset(page.handle(), index);
    uint64_t bytes = TIFFGetStrileByteCount(page.handle(), index);
    const int64_t row_of_blocks = block / layout.blocks_across() % layout.blocks_down();
    const int64_t decoded = layout.rows_of_block(row_of_blocks) * layout.block_row_bytes();
    // Caps the size: old programs state excess bytes, up to the next strip's start or beyond the end of the file.
    if (layout.compression == COMPRESSION_NONE) bytes = std::min(bytes, uint64_t(decoded));
    const auto refuse = [&](const auto&... words) {
        fail(page.subject(), ": ", name_of_block(layout), block + 1, " of ", layout.blocks(), words...);
    };
    if (offset == 0 || bytes == 0) {
        refuse(" is missing: ", name_of_byte_counts(layout), " is ", bytes, "; expected voxels for all of the page");
    }
    if (!file.holds(offset, bytes)) {
        refuse(" is ", bytes, " bytes at byte ", offset, " by ", name_of_byte_counts(layout),
               "; expected it within the ", file.size_bytes(), " bytes of the file: it is truncated or damaged");
    }
    if (decoded > most_decoded(layout, int64_t(bytes))) {
        refuse(" is ", bytes, " bytes by ", name_of_byte_counts(layout), "; expected enough for ", decoded,
               " bytes of voxels");
    }
    return {int64_t(offset), int64_t(bytes)};
}

void check_blocks(const TiffFile& file, const TiffPage& page, const TiffLayout& layout)
{
    check_amount(file, layout, 1);
    // Each block takes at least one byte of the file, so this bounds the memory for the list of blocks.
    if (layout.blocks() > file.size_bytes()) {
        fail(page.subject(), ": has ", layout.blocks(), " strips or tiles; expected at most one for each of the ",
             file.size_bytes(), " bytes of the file");
    }
    std::vector<TiffExtent> extents;
    extents.reserve(size_t(std::min<int64_t>(layout.blocks(), 65536)));
    for (int64_t block = 0; block < layout.blocks(); ++block) {
        extents.push_back(extent_of_block(file, page, layout, block));
    }
    std::sort(extents.begin(), extents.end(),
              [](const TiffExtent& a, const TiffExtent& b) { return a.offset < b.offset; });
    for (size_t i = 1; i < extents.size(); ++i) {
        const int64_t end = extents[i - 1].offset + extents[i - 1].bytes;
        if (end <= extents[i].offset) continue;
        fail(page.subject(), ": a ", name_of_block(layout), "starts at byte ", extents[i].offset,
             "; expected at least ", end, ", where the one before it ends: they overlap");
    }
}

void check_amount(const TiffFile& file, const TiffLayout& layout, int64_t pages)
{
    int64_t bytes = 0;
    const bool overflows = __builtin_mul_overflow(layout.page_bytes(), pages, &bytes);
    if (!overflows && bytes <= most_decoded(layout, file.size_bytes())) return;
    fail(file.path().string(), ": holds ", file.size_bytes(), " bytes; expected enough for ", pages,
         pages == 1 ? " page of " : " pages of ", in_words(layout), ": it is truncated, or ImageWidth and ImageLength",
         " are wrong");
}

int64_t decoding_memory(const TiffFile& file, const TiffLayout& layout)
{
    return DIRECTORY_MEMORY + file.size_bytes() + 4 * layout.block_row_bytes() * layout.rows_of_block(0);
}

}  // namespace shvr
