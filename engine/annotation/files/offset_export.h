#pragma once
// Density offsets in forms that other programs read. Any thread may call these.
//
//   .offset      the thesis's bare numbers (offset_file.h)
//   .nrrd .tif   engine/formats/export/volume_export.h: floats of 32 bits, which hold every offset of volumes of 8 and 16 bits and of
//                floats; of volumes of integers of 32 bits, integers of 32 bits

#include <filesystem>

#include "engine/annotation/density.h"

namespace shvr {

bool is_offset_export(const std::filesystem::path& path);

/// Replaces an old file at once or not at all. `volume`, of the field's size, says where the voxels lie.
void export_offsets(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume);

}  // namespace shvr
