#pragma once
// Which image a mask was painted on. A `.mask` file is raw bytes, and fits any scan of the same size; so MASK.json
// beside it holds {"shvr_mask": 1, "image": "xxh3-128:..."}, the hash of the image's voxels
// (engine/volume/content_hash.h). A label image has that in its attributes, under "shvr". A mask without it, as other
// programs write them, is identified by its size alone.
//
// Both also name the journal that the mask was saved with, and a record of it: so a journal that is missing, older than
// the mask, or another one is noticed.

#include <filesystem>
#include <optional>
#include <string>

#include "engine/projects/import_volume.h"

namespace shvr {

/// "paint.mask.json" for "paint.mask".
std::filesystem::path mask_image_path(const std::filesystem::path& mask);

/// The journal at the time of a save.
using MaskJournal = LabelImage::Journal;

/// Writes MASK.json atomically. An empty hash (the image was never hashed) leaves the old one. Does nothing for
/// folders, which state the same themselves (LabelImage).
void save_mask_image(const std::filesystem::path& mask, const std::string& content_hash,
                     const std::optional<MaskJournal>& journal = {});
/// What MASK.json or the label image says of the journal; nothing if it says nothing, is missing or malformed.
std::optional<MaskJournal> journal_of_mask(const std::filesystem::path& mask);
/// The file or folder that `journal_of_mask` asks, for messages.
std::filesystem::path journal_is_named_in(const std::filesystem::path& mask);

/// Fails if the mask was painted on an image with another hash, or MASK.json is malformed. Accepts an empty hash,
/// and a mask without MASK.json.
void check_mask_image(const std::filesystem::path& mask, const std::string& content_hash);

}  // namespace shvr
