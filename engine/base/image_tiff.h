#pragma once
// Writes pictures as TIFF files, row by row, and reads the texts in them. Any thread.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/image_file.h"

namespace shvr {

/// Whether the name ends in .tif or .tiff.
bool is_tiff_name(const std::filesystem::path& path);

/// Writes 8-bit sRGB, deflated, with the texts in the image description and the resolution of PICTURE_DPI. Alpha is
/// written only if a pixel is not opaque, since publishers refuse it. Fails for pictures of more than 571 million
/// pixels.
std::unique_ptr<ImageWriter> tiff_writer(const std::filesystem::path& path, int64_t width, int64_t height,
                                         const PictureTexts& texts);

/// Returns the text with `keyword` in a file that tiff_writer wrote; null if there is none or the file is another one.
/// Reads no pixels.
std::optional<std::string> read_tiff_text(const std::filesystem::path& path, std::string_view keyword);

}  // namespace shvr
