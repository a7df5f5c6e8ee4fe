#pragma once
// The thesis's file of density offsets: one signed little-endian number per voxel, x fastest, no header. 16 bits for
// volumes of 8 bits, 32 bits for volumes of 16 or 32; for float volumes, a float of 32 bits.

#include <filesystem>

#include "engine/annotation/density.h"
#include "engine/base/progress.h"

namespace shvr {

/// Writes row by row to a temporary file next to `path`, syncs and renames it: a failed save leaves the old
/// file. An exception from `progress` cancels it.
void save_offsets(const std::filesystem::path& path, const DensityField& field, const Progress& progress = {});

/// Fails if the file's size is not that of such a volume's offsets (naming both), or if an offset is not finite or
/// beyond `offset_limit`.
DensityField load_offsets(const std::filesystem::path& path, const Size3& size, VoxelType type);

}  // namespace shvr
