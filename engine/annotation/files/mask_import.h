#pragma once
// Masks in any supported format. Formats that state their size must match the volume; for raw bytes only their number
// is checked. Any thread may call these.
//
//   a folder                       an OME-Zarr label image, or another OME-Zarr image of uint8
//   .ozx .zip, and paths inside    the same, in an archive
//   .nrrd .nhdr .mhd .mha .nii     volumes of uint8 in these formats, as read by engine/formats
//   .tif .tiff
//   anything else                  the thesis's raw bytes (mask_file.h)

#include <filesystem>

#include "engine/annotation/files/mask_export.h"

namespace shvr {

/// The records that turn an unpainted mask into this one. Fails if its size or stated spacing or place differs (naming
/// both), or if its voxels are not unsigned bytes.
std::vector<MaskBrickChange> import_mask(const std::filesystem::path& path, const TraceSpace& space);
/// Saves in the format that the path names, or as raw bytes if `export_mask` does not support it. Fails for formats
/// that can only be read. `image`, `foreign` and the result: as for `export_mask`.
std::string save_mask_as(const std::filesystem::path& path, const Mask& mask, const VolumeInfo& volume,
                         const LabelImage& image = {}, Foreign foreign = Foreign::refused);

}  // namespace shvr
