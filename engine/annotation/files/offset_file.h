#pragma once
// The thesis's file of density offsets: one signed little-endian number for each voxel, x fastest, no header. 16 bits
// where the volume has 8, 32 bits where it has 16 or 32; for volumes of floats, a float of 32 bits.

#include <filesystem>

#include "engine/annotation/density.h"

namespace shvr {

/// Written to a temporary file beside `path`, synced and renamed, row by row: a failed save leaves the old file.
void save_offsets(const std::filesystem::path& path, const DensityField& field);

/// Fails if the file's size is not that of such a volume's offsets (naming both), or if an offset is not finite or
/// beyond `offset_limit`.
DensityField load_offsets(const std::filesystem::path& path, const Size3& size, VoxelType type);

}  // namespace shvr
