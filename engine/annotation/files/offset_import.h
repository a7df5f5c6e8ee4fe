#pragma once
// Density offsets in any supported format. Formats that state their size must match the volume; for raw numbers only
// their count is checked. Any thread may call these.
//
//   .zarr .nrrd .tif and others  volumes of one offset per voxel, of any type, as read by engine/formats
//   anything else                the thesis's raw numbers (offset_file.h)

#include "engine/annotation/files/offset_export.h"
#include "engine/annotation/trace/trace_file.h"

namespace shvr {

/// Reads the offsets of a volume of `type`; files from `export_offsets` are restored bit for bit. Fails if size or
/// stated spacing differs (naming both), if an offset is not finite or exceeds `offset_limit`, or if an offset of an
/// integer volume is not a whole number.
DensityField import_offsets(const std::filesystem::path& path, const TraceSpace& space, VoxelType type);

/// Saves in the format that the path names, or as raw numbers if `export_offsets` does not support that format. Fails
/// for read-only formats. `foreign` and the returned message are as for `export_mask`.
std::string save_offsets_as(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume,
                            Foreign foreign = Foreign::refused, const Progress& progress = {});

}  // namespace shvr
