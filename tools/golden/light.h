#pragma once
// Pictures in linear light with 32-bit floats: portable float maps (PFM), as written by `write_pfm`
// (engine/base/image_file.h).

#include <filesystem>

#include "engine/base/image.h"

namespace shvr::golden {

/// Reads three channels and sets alpha to 1. Fails if the file is not a portable float map of that form.
ImageF read_light(const std::filesystem::path& path);

/// Returns the largest difference of any channel between two pictures, which must have the same size.
double largest_difference(const ImageF& a, const ImageF& b);

}  // namespace shvr::golden
