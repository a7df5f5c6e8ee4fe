#pragma once
// Pictures in linear light, as 32-bit floats: portable float maps in the form that `write_pfm` writes
// (engine/base/image_file.h).

#include <filesystem>

#include "engine/base/image.h"

namespace shvr::golden {

/// Reads three channels; alpha is 1. Fails if the file is not such a picture.
ImageF read_light(const std::filesystem::path& path);

/// Returns the largest difference in any channel between two pictures of the same size.
double largest_difference(const ImageF& a, const ImageF& b);

}  // namespace shvr::golden
