#pragma once
// Converts voxels of any type to doubles, which can hold every value of every type, and back. Any thread.

#include <span>

#include "engine/volume/volume.h"

namespace shvr {

/// Loads values.size() voxels of `type`, aligned or not.
void load_voxels(VoxelType type, const std::byte* voxels, std::span<double> values);

/// Stores values as voxels of `type`. Integers are rounded to nearest, halves up. Values must be finite and, for
/// integer types, within the range of `type`.
void store_voxels(VoxelType type, std::span<const double> values, std::byte* voxels);

}  // namespace shvr
