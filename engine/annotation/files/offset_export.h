#pragma once
// Density offsets in formats that other programs read. Any thread may call these.
//
//   .offset      the thesis's raw numbers (offset_file.h)
//   .nrrd .tif   engine/formats/export/volume_export.h: 32-bit floats, which hold every offset of 8-bit, 16-bit and
//                float volumes exactly; 32-bit integers for volumes of 32-bit integers
//   .zarr        an OME-Zarr image of level 0 that holds only the painted offsets: 32-bit integers for
//                integer volumes, 32-bit floats for float volumes

#include <filesystem>

#include "engine/annotation/density.h"
#include "engine/base/progress.h"
#include "engine/projects/import_sparse.h"

namespace shvr {

bool is_offset_export(const std::filesystem::path& path);

/// Exports the offsets, and atomically replaces an existing file. `volume`, which has the field's size,
/// gives the voxels' positions. `foreign` and the returned message have the same meaning as for
/// `export_mask`.
std::string export_offsets(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume,
                           const Progress& progress = {}, Foreign foreign = Foreign::refused);

}  // namespace shvr
