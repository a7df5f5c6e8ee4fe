#pragma once
// The relevance pass on the host, used by replay without a device and when the device is late. Computes the bits from
// the file's own voxels; the bits equal those of a query (region_query.h). Any thread.

#include <bitset>

#include "engine/annotation/mask.h"
#include "engine/live/felt_limits.h"
#include "engine/live/relevance.h"
#include "engine/touch/region_wish.h"
#include "engine/volume/source.h"

namespace shvr {

/// Returns the cube of `side` voxels around a point (in voxels). At the volume's borders the cube is shifted inside, so
/// that it stays as large as possible. Fails if the point is not finite.
VoxelBox relevance_cube(const glm::dvec3& voxel, const Size3& volume_size, int64_t side);

/// Returns the cube to query for a ball, shifted ahead along its motion. Fails if the point is not finite.
RelevancePlace relevance_place(const VolumeSource& source, const RegionWish& wish);

/// Finds the voxels at or above the threshold in a box of a level. `source` must include the density offsets.
RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold);
/// Like relevance_on_host() above, but excludes unpainted voxels whose intensities cannot be felt; apply_limits applies
/// other limits. A coarser level's voxel is painted if at least half of its voxels are. `mask`: null if unpainted.
RelevanceBits relevance_on_host(const VolumeSource& source, int level, const VoxelBox& box, double threshold,
                                const FeltLimits& limits, const Mask* mask);

/// Clears the bits of voxels outside these groups. The bit of a coarser level's voxel stays if at least half of the
/// painted voxels that it covers, and at least one, are in these groups. Unpainted voxels count only if group 0 is
/// included. So a completely painted object feels the same with or without the limit, on any level. `mask` must cover
/// the volume.
void limit_to_groups(const Mask& mask, const std::bitset<256>& groups, RelevanceBits& bits);

}  // namespace shvr
