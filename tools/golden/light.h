#pragma once
// Pictures in linear light, 32-bit floats, as portable float maps: what `write_pfm` writes (engine/base/image_file.h).

#include <filesystem>

#include "engine/base/image.h"

namespace shvr::golden {

/// Of three channels; alpha is 1. Fails where the file is no such picture.
ImageF read_light(const std::filesystem::path& path);

/// The largest difference in any channel of two pictures of one size.
double largest_difference(const ImageF& a, const ImageF& b);

}  // namespace shvr::golden
