#pragma once
// Intensities of single voxels on the host, with the offsets of density painting added, for a probe. Any thread, as
// long as nothing changes the offsets.

#include "engine/annotation/density.h"
#include "engine/annotation/trace/local_radius.h"
#include "engine/volume/source.h"

namespace shvr {

/// Reads the voxels of a box inside the volume. Fails if they cannot be read.
DensityBox densities_in(const VolumeSource& source, const DensityField& offsets, const VoxelBox& box);

}  // namespace shvr
