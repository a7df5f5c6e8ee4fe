#pragma once
// Which image a mask was painted on. A `.mask` file is bare bytes, and two scans of one size would take each other's; so
// MASK.json beside it holds {"shvr_mask": 1, "image": "xxh3-128:..."}, the hash of the image's voxels
// (engine/volume/content_hash.h). A label image has that in its attributes, under "shvr". A mask without it, as other programs
// write them, is told by its size alone.

#include <filesystem>
#include <string>

namespace shvr {

/// "paint.mask.json" for "paint.mask".
std::filesystem::path mask_image_path(const std::filesystem::path& mask);

/// Whole or not at all. An empty hash, of an image that was not gone through, leaves what is there. Nothing is done for
/// folders, which say it themselves.
void save_mask_image(const std::filesystem::path& mask, const std::string& content_hash);

/// Fails where the mask was painted on an image of another hash, or MASK.json holds no such thing. An empty hash, and a
/// mask without MASK.json, are let pass.
void check_mask_image(const std::filesystem::path& mask, const std::string& content_hash);

}  // namespace shvr
