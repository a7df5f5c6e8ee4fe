#pragma once
// PNG files in and out, PFM files out. Written are 8-bit RGBA files with an sRGB chunk; read is every PNG there is.
// Files come from strangers: sizes are checked before memory is taken. Any thread may call these.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "engine/base/image.h"

namespace shvr {

/// Pictures with more pixels are neither read nor written.
inline constexpr int64_t MOST_IMAGE_PIXELS = int64_t{1} << 28;

/// Grey, palette and colour files of 1 to 16 bits become 8-bit RGBA. Values are taken as sRGB unless the file says
/// otherwise (gAMA chunk); then libpng converts them, with a power of 2.2 for the sRGB curve (up to 9 levels off near
/// black, 2 in the middle).
Image8 read_png(const std::filesystem::path& path);
/// Replaces an old file at once or, on failure, not at all (atomic_file.h).
void write_png(const std::filesystem::path& path, const Image8& image);

/// Portable float map, "PF": the RGB of the picture as it is, linear light premultiplied by alpha, which is left out.
/// Replaces an old file as `write_png` does.
void write_pfm(const std::filesystem::path& path, const ImageF& image);

/// The same for files in memory; `name` stands in messages.
Image8 decode_png(std::span<const std::byte> file, std::string_view name);
std::vector<std::byte> encode_png(const Image8& image, std::string_view name);

}  // namespace shvr
