#pragma once
// Records the image on which a mask was painted. A `.mask` file is raw bytes and fits any scan of the same size.
// Therefore MASK.json next to it holds {"shvr_mask": 1, "image": "xxh3-128:..."}, the hash of the image's voxels
// (engine/volume/content_hash.h). A label image has the hash in its attributes, under "shvr". For a mask without a
// hash, as written by other programs, only the size is checked.
//
// MASK.json and the attributes also name the journal that belonged to the mask when it was saved, and one of its
// records. They reveal whether the journal is now missing, older than the mask, or a different one.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "engine/projects/import_volume.h"

namespace shvr {

/// "paint.mask.json" for "paint.mask".
std::filesystem::path mask_image_path(const std::filesystem::path& mask);

/// The mask's journal at the time of a save.
using MaskJournal = LabelImage::Journal;

/// Writes MASK.json atomically. If `content_hash` is empty because the image was not hashed, the file keeps its old
/// hash. Does nothing for folders, whose attributes hold the hash (LabelImage).
void save_mask_image(const std::filesystem::path& mask, const std::string& content_hash,
                     const std::optional<MaskJournal>& journal = {});
/// The journal that MASK.json or the label image names; null if none is named, or the file is missing or malformed.
std::optional<MaskJournal> journal_of_mask(const std::filesystem::path& mask);
/// The path of the file or folder that `journal_of_mask` reads, for messages.
std::filesystem::path journal_is_named_in(const std::filesystem::path& mask);

/// Fails if the mask was painted on an image with another hash, or if MASK.json is malformed. Accepts an empty hash or
/// a missing MASK.json. `is_other_name(hash)`: whether this different hash stands for the same image; empty: never.
void check_mask_image(const std::filesystem::path& mask, const std::string& content_hash,
                      const std::function<bool(const std::string& hash)>& is_other_name = {});

}  // namespace shvr
