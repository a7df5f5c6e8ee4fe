#pragma once
// The relevance pass on the host: the same bits from the file's own voxels, for replay without a device and for where
// the device is late. Equal to the device's wherever 16-bit codes hold the intensities exactly (IntensityWindow); of
// other volumes a voxel within half a code of the threshold may differ. Any thread.

#include <bitset>

#include "engine/annotation/mask.h"
#include "engine/live/relevance.h"
#include "engine/volume/source.h"

namespace shvr {

/// The cube of `side` voxels around a point (voxels), shifted inside the volume at its borders, so that it is as large
/// as possible. Fails where the point is not finite.
VoxelBox relevance_cube(const glm::dvec3& voxel, const Size3& volume_size, int64_t side);

/// Where to look for a ball around `point`, physical units. Fails where the point is not finite.
RelevancePlace relevance_place(const VolumeSource& source, const glm::dvec3& point, double radius);

/// Which voxels of a box of a level are at or above the threshold. `source` holds density offsets already.
RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold);

/// Clears the bits of voxels in other groups than these. A voxel of a coarser level counts by what is painted of those
/// that it covers: it stays where at least half of them, and at least one, is of these groups. Unpainted ones count
/// only where group 0 is among these. So what is painted entirely feels the same limited or not, on any level. `mask`
/// is of the volume.
void limit_to_groups(const Mask& mask, const std::bitset<256>& groups, RelevanceBits& bits);

}  // namespace shvr
