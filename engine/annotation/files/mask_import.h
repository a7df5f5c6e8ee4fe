#pragma once
// Masks in whatever form they come. Those that say themselves how large they are must be of this volume; of bare bytes only
// their number tells. Any thread may call these.
//
//   a folder                       an OME-Zarr label image, or another OME-Zarr image of uint8
//   .nrrd .nhdr .mhd .mha .nii     volumes of uint8 in these forms, as the readers of engine/volume know them
//   .tif .tiff
//   anything else                  the thesis's raw bytes (mask_file.h)

#include <filesystem>

#include "engine/annotation/files/mask_export.h"

namespace shvr {

/// The records that make an unpainted mask of this one. Fails where it is of another size or, where it states one, spacing
/// (of which both are named), and where it is not of 8 bits without sign.
std::vector<MaskBrickChange> import_mask(const std::filesystem::path& path, const TraceSpace& space);
/// Saves in the form that the path names: as bare bytes where it is none that `export_mask` knows. Fails where it is a form
/// that can be read and not written. `image`: as `export_mask`.
void save_mask_as(const std::filesystem::path& path, const Mask& mask, const VolumeInfo& volume,
                  const LabelImage& image = {});

}  // namespace shvr
