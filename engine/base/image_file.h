#pragma once
// Reads and writes PNG files, and writes PFM files. Writes 8-bit RGBA with an sRGB chunk, row by row if wanted; reads
// every kind of PNG. Files are untrusted: sizes are checked before memory is allocated. Any thread may call these.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/image.h"

namespace shvr {

/// Maximum number of pixels of a picture that is read from a file or written from memory.
inline constexpr int64_t MAX_IMAGE_PIXELS = int64_t{1} << 28;
/// Maximum side in pixels of a picture that is written row by row.
inline constexpr int64_t MAX_IMAGE_SIDE = 65536;

/// Grey, palette and colour files of 1 to 16 bits become 8-bit RGBA. Values are taken as sRGB unless the file says
/// otherwise (gAMA chunk); then libpng converts them, approximating the sRGB curve by a power of 2.2 (up to 9 levels
/// off near black, 2 in the middle).
Image8 read_png(const std::filesystem::path& path);
/// Texts in a picture file, in UTF-8, each with its keyword (1 to 79 Latin letters and single spaces). The texts are
/// written compressed (iTXt), before the pixels. Each text has at most MAX_PICTURE_TEXT bytes.
using PictureTexts = std::vector<std::pair<std::string, std::string>>;
inline constexpr size_t MAX_PICTURE_TEXT = size_t{16} << 20;
/// Keyword of the text that states the resolution in dots per inch, as a number. It is also written as a pHYs chunk or
/// as the tags of a TIFF, which other programs read.
inline constexpr const char* PICTURE_DPI = "SHVR dots per inch";
/// Null if the texts do not state it.
std::optional<double> dots_per_inch_of(const PictureTexts& texts);
/// Returns the first text with `keyword` (iTXt, zTXt or tEXt) before the pixels; null if there is none or the file is
/// not a PNG file. Reads no pixels. Fails if the text is damaged or larger than MAX_PICTURE_TEXT.
std::optional<std::string> read_png_text(const std::filesystem::path& path, std::string_view keyword);
/// Replaces an existing file atomically; leaves it untouched on failure (atomic_file.h).
void write_png(const std::filesystem::path& path, const Image8& image, const PictureTexts& texts = {});

/// Writes a picture file row by row, with memory for only a few rows. `commit` gives the file its final name; without
/// `commit` the old file stays as it was and nothing else is left (atomic_writer.h). One thread at a time.
class ImageWriter {
public:
    virtual ~ImageWriter() = default;
    ImageWriter(const ImageWriter&) = delete;
    ImageWriter& operator=(const ImageWriter&) = delete;

    /// Adds the next rows from the top, as wide as the picture. Fails if they cannot be written.
    virtual void add(const ImageF& rows) = 0;
    /// Completes the file once all rows have been added.
    virtual void commit() = 0;

protected:
    ImageWriter() = default;
};
/// If the name ends in .pfm, writes as `write_pfm` does, without texts; if it ends in .tif or .tiff, a TIFF
/// (image_tiff.h); otherwise writes as `write_png` does and converts light as `to_image8` does.
std::unique_ptr<ImageWriter> image_writer(const std::filesystem::path& path, int64_t width, int64_t height,
                                          const PictureTexts& texts = {});

/// Writes a portable float map, "PF": the picture's RGB unchanged, in linear light premultiplied by alpha, without the
/// alpha. Replaces an existing file like `write_png`.
void write_pfm(const std::filesystem::path& path, const ImageF& image);

/// Like `read_png`, for a file in memory; `name` is used in messages.
Image8 decode_png(std::span<const std::byte> file, std::string_view name);
std::vector<std::byte> encode_png(const Image8& image, std::string_view name);

}  // namespace shvr
