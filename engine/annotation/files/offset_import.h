#pragma once
// Density offsets in any supported form. Forms that state their size must match the volume; raw numbers are checked by
// their count alone. Any thread may call these.
//
//   .nrrd .tif and the others    volumes of one offset a voxel, of any type, as the readers of engine/volume know them
//   anything else                the thesis's raw numbers (offset_file.h)

#include "engine/annotation/files/offset_export.h"
#include "engine/annotation/trace/trace_file.h"

namespace shvr {

/// The offsets for a volume of `type`; files of `export_offsets` are restored bit for bit. Fails if the size or stated
/// spacing differs (naming both), if an offset is not finite or beyond `offset_limit`, or if an offset for a volume of
/// integers is not a whole number.
DensityField import_offsets(const std::filesystem::path& path, const TraceSpace& space, VoxelType type);

/// Saves in the form that the path names: raw numbers where `export_offsets` does not know it. Fails for forms that can
/// only be read.
void save_offsets_as(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume);

}  // namespace shvr
