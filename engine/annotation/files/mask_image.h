#pragma once
// Which image a mask was painted on. A `.mask` file is raw bytes, and fits any scan of the same size; so MASK.json
// beside it holds {"shvr_mask": 1, "image": "xxh3-128:..."}, the hash of the image's voxels
// (engine/volume/content_hash.h). A label image has that in its attributes, under "shvr". A mask without it, as other
// programs write them, is identified by its size alone.
//
// MASK.json also names the journal that the mask was saved with, and a record of it: so a journal that is missing,
// older than the mask, or another one is noticed.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace shvr {

/// "paint.mask.json" for "paint.mask".
std::filesystem::path mask_image_path(const std::filesystem::path& mask);

/// The journal at the time of a save: its file's name, and number and checksum of its last record.
struct MaskJournal {
    std::string name;
    uint64_t record = 0, checksum = 0;
    bool operator==(const MaskJournal&) const = default;
};

/// Writes MASK.json atomically. An empty hash (the image was never hashed) leaves the old one. Does nothing for
/// folders, which state the hash themselves.
void save_mask_image(const std::filesystem::path& mask, const std::string& content_hash,
                     const std::optional<MaskJournal>& journal = {});
/// What MASK.json says of the journal; nothing if it says nothing, is missing or malformed.
std::optional<MaskJournal> journal_of_mask(const std::filesystem::path& mask);

/// Fails if the mask was painted on an image with another hash, or MASK.json is malformed. Accepts an empty hash,
/// and a mask without MASK.json.
void check_mask_image(const std::filesystem::path& mask, const std::string& content_hash);

}  // namespace shvr
