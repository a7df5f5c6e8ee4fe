#pragma once
// Which way round the bytes of a voxel are. Any thread may call these.

#include <span>
#include <string>

#include "engine/formats/voxel_bytes.h"
#include "engine/volume/volume.h"

namespace shvr {

/// Turns each group of `voxel_bytes` (1, 2, 4 or 8) round.
void swap_bytes(std::span<std::byte> voxels, size_t voxel_bytes);

/// What to say where nobody states the byte order and little-endian is taken. `bytes` (or null: do not look) holds the
/// voxels of `info`, x fastest; where neighbours are much more often nearer to each other in the other order, the
/// sentence says so, as a guess.
std::string byte_order_warning(const VolumeInfo& info, const VoxelBytes* bytes);

}  // namespace shvr
