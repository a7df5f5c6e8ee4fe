#pragma once
// Intensities of single voxels near a probe, read on the host, including the offsets of density painting. Any thread
// may call this while nothing changes the offsets.

#include "engine/annotation/density.h"
#include "engine/annotation/trace/local_radius.h"
#include "engine/volume/source.h"

namespace shvr {

/// Reads the voxels of a box inside the volume. Fails if the voxels cannot be read.
DensityBox densities_in(const VolumeSource& source, const DensityField& offsets, const VoxelBox& box);
/// Adds the offsets of the voxels in `box`, whose intensities are in `densities`.
void add_offsets(const DensityField& offsets, const VoxelBox& box, DensityBox& densities);

}  // namespace shvr
