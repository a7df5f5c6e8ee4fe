#pragma once
// The voxels that brushes select in a region, by simple breadth-first search. Tests compare the device's words with
// these, bit for bit.
//
// `open(voxel)` says whether a voxel of the volume is at or above the threshold; it is called for the region's voxels
// only. Words are laid out as BrushRegion says; bits outside the region's spans are 0. `connectivity` is 6 or 26.

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/annotation/region.h"

namespace shvr::reference {

using OpenVoxel = std::function<bool(Size3)>;

/// Every open voxel.
std::vector<uint32_t> fill_words(const BrushRegion& region, const OpenVoxel& open);

/// The open voxels connected to `seed` through open voxels of the region. The seed is the voxel that contains the
/// probe's centre, the floor of its position; one that is outside the region or not open selects nothing.
std::vector<uint32_t> flood_words(const BrushRegion& region, const OpenVoxel& open, Size3 seed, int connectivity);

/// The components of open voxels that hold no edge voxel of the region, which is one with a face neighbour that does
/// not belong to the region (no voxel outside the volume does). A neighbour that belongs but is not open makes no edge.
std::vector<uint32_t> speckle_words(const BrushRegion& region, const OpenVoxel& open, int connectivity);

/// A label for each voxel of a whole volume, x fastest: 0 if it is not open, else the number of its component, counted
/// from 1 in the order of first voxels.
std::vector<uint32_t> component_labels(const Size3& size, const OpenVoxel& open, int connectivity);

}  // namespace shvr::reference
