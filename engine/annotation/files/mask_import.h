#pragma once
// Masks in any supported format. Formats that state their size must match the volume; for raw bytes only the number of
// bytes is checked. Any thread may call these.
//
//   a folder                       an OME-Zarr label image, or another OME-Zarr image of uint8
//   .ozx .zip, and paths inside    the same, in an archive
//   files that state their size    volumes of whole numbers from 0 to 255 of any type, as read by engine/formats
//   anything else                  the thesis's raw bytes (mask_file.h)

#include <filesystem>

#include "engine/annotation/files/mask_export.h"

namespace shvr {

struct ImportedMask {
    std::vector<MaskBrickChange> changes{};  ///< the changes that turn an unpainted mask into this mask
    std::vector<std::string> losses{};       ///< content of the file that a mask cannot hold, one sentence each
    std::vector<std::string> remarks{};      ///< where the mask was placed, and which groups its segments became
};
/// Places a mask of another size or position on the volume's grid (mask_place.h), and merges the layers of a
/// segmentation (mask_segments.h). Fails if the mask's stated spacing or place does not fit the volume's (naming both),
/// or if a voxel (of whatever type) is not a whole number from 0 to 255.
ImportedMask import_mask(const std::filesystem::path& path, const TraceSpace& space);

/// Whether `save_mask_as` can write to the path. If not, the format is read-only.
bool is_mask_writable(const std::filesystem::path& path);
/// Returns the path for saving a mask that was read from `mask`: the same path or, if its format is read-only,
/// NAME.labels.zarr next to it. A path in an archive is returned unchanged, although masks cannot be saved there.
std::filesystem::path saved_mask_path(const std::filesystem::path& mask);
/// Saves in the format that the path names, or as raw bytes if `export_mask` does not support that format. Fails for
/// read-only formats. `image`, `foreign` and the returned message are as for `export_mask`.
std::string save_mask_as(const std::filesystem::path& path, const Mask& mask, const VolumeInfo& volume,
                         const LabelImage& image = {}, Foreign foreign = Foreign::refused,
                         const Progress& progress = {});

}  // namespace shvr
