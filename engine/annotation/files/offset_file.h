#pragma once
// The thesis's file of density offsets: one signed little-endian number per voxel, x fastest, no header. Numbers have
// 16 bits for 8-bit volumes, and 32 bits for 16-bit and 32-bit volumes; for float volumes they are 32-bit floats.

#include <filesystem>

#include "engine/annotation/density.h"
#include "engine/base/progress.h"

namespace shvr {

/// Writes row by row to a temporary file next to `path`, then syncs and renames it, so a failed save leaves the old
/// file untouched. An exception from `progress` cancels the save.
void save_offsets(const std::filesystem::path& path, const DensityField& field, const Progress& progress = {});

/// Fails if the file's size is not that of the offsets of such a volume (naming both sizes), or if an offset is not
/// finite or exceeds `offset_limit`.
DensityField load_offsets(const std::filesystem::path& path, const Size3& size, VoxelType type);

}  // namespace shvr
