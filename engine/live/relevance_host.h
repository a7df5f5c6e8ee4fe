#pragma once
// The relevance pass on the host: the same bits from the file's own voxels, for replay without a device and for when
// the device is late. Equal to those of a query (region_query.h). Any thread.

#include <bitset>

#include "engine/annotation/mask.h"
#include "engine/live/felt_limits.h"
#include "engine/live/relevance.h"
#include "engine/touch/region_wish.h"
#include "engine/volume/source.h"

namespace shvr {

/// The cube of `side` voxels around a point (voxels), shifted inside the volume at its borders, so that it is as large
/// as possible. Fails if the point is not finite.
VoxelBox relevance_cube(const glm::dvec3& voxel, const Size3& volume_size, int64_t side);

/// The cube to query for a ball, ahead of it where it moves. Fails if the point is not finite.
RelevancePlace relevance_place(const VolumeSource& source, const RegionWish& wish);

/// Which voxels of a box of a level are at or above the threshold. `source` already includes density offsets.
RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold);
/// Likewise, without unpainted voxels whose intensities are not felt; apply_limits does the rest. A voxel of a coarser
/// level is painted if at least half of the voxels that it covers are. `mask`: null: nothing is painted.
RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold,
                                const FeltLimits& limits, const Mask* mask);

/// Clears the bits of voxels outside these groups. A voxel of a coarser level counts by the painted voxels that it
/// covers: it stays if at least half of them, and at least one, are in these groups. Unpainted voxels count only if
/// group 0 is included. So a completely painted object feels the same with or without the limit, on any level. `mask`
/// covers the volume.
void limit_to_groups(const Mask& mask, const std::bitset<256>& groups, RelevanceBits& bits);

}  // namespace shvr
