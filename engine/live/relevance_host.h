#pragma once
// The relevance pass on the host: the same bits from the file's own voxels, for replay without a device and for where
// the device is late. Equal to the device's wherever 16-bit codes hold the intensities exactly (IntensityWindow); of
// other volumes a voxel within half a code of the threshold may differ. Any thread.

#include "engine/live/relevance.h"
#include "engine/volume/source.h"

namespace shvr {

/// The cube of `side` voxels around a point (voxels), shifted inside the volume at its borders, so that it is as large
/// as possible. Fails where the point is not finite.
VoxelBox relevance_cube(const glm::dvec3& voxel, const Size3& volume_size, int64_t side);

/// Which voxels of a box of a level are at or above the threshold. `source` holds density offsets already.
RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold);

}  // namespace shvr
