#pragma once
// The byte order of voxels. Any thread may call these.

#include <span>
#include <string>

#include "engine/formats/voxel_bytes.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Reverses each group of `voxel_bytes` bytes (1, 2, 4 or 8).
void swap_bytes(std::span<std::byte> voxels, size_t voxel_bytes);

/// Returns the warning for files that do not state their byte order and are read as little-endian. `bytes` holds the
/// voxels of `info`, x fastest, or is null. If neighbouring voxels are much more similar when read as big-endian, the
/// warning suggests big-endian as a guess. Without `bytes`, no voxels are inspected.
std::string byte_order_warning(const VolumeInfo& info, const VoxelBytes* bytes);

}  // namespace shvr
