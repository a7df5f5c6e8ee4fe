#pragma once
// A volume as one file that other programs read. Voxels are read strip by strip and go to the disk as they come.
//
//   .nrrd        raw voxels behind a header with spacing and unit, little-endian
//   .tif .tiff   a page a slice, deflated; spacing and unit as ImageJ has them; BigTIFF where it must be
//
// Any thread may call these.

#include <filesystem>

#include "engine/volume/source.h"

namespace shvr {

bool is_volume_export(const std::filesystem::path& path);

/// Replaces an old file at once or not at all. Fails where the extension is another one.
void export_volume(const std::filesystem::path& path, const VolumeSource& source);

/// One form each; for volume_export.cpp.
void export_nrrd(const std::filesystem::path& path, const VolumeSource& source);
void export_tiff(const std::filesystem::path& path, const VolumeSource& source);

/// The rows of a slice that an export reads at once: 256 KiB, or one row.
int64_t export_rows(const VolumeInfo& info);

}  // namespace shvr
