#pragma once
// A mask in formats that other programs read. Any thread may call this.
//
//   .mask        the thesis's raw bytes (mask_file.h)
//   .nrrd .tif   engine/formats/export/volume_export.h
//   .zarr        an OME-Zarr label image with resolution levels, also as PROJECT/labels/NAME

#include <filesystem>

#include "engine/annotation/mask.h"
#include "engine/annotation/trace/trace_file.h"
#include "engine/projects/import_sparse.h"

namespace shvr {

bool is_mask_export(const std::filesystem::path& path);

/// Replaces an existing file (or label image) atomically. `volume` has the mask's size and gives the voxels' positions;
/// `image` holds additional metadata of a label image; `version` is as in `ImportOptions`. Returns a message if, as
/// `foreign` demands, it keeps the old image under another name (engine/projects/import_sparse.h).
std::string export_mask(const std::filesystem::path& path, const Mask& mask, const VolumeInfo& volume,
                        const LabelImage& image = {}, std::optional<OmeZarrVersion> version = {},
                        const Progress& progress = {}, Foreign foreign = Foreign::refused);

}  // namespace shvr
