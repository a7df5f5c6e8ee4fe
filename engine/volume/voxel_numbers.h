#pragma once
// Converts voxels of any type to and from doubles, which can represent all values of all types. Any thread.

#include <span>

#include "engine/volume/volume.h"

namespace shvr {

/// Loads values.size() voxels of `type`, whose address need not be aligned.
void load_voxels(VoxelType type, const std::byte* voxels, std::span<double> values);

/// Stores values as voxels of `type`. Integers are rounded to nearest, halves up. Values must be finite and, for
/// integer types, lie within the range of `type`.
void store_voxels(VoxelType type, std::span<const double> values, std::byte* voxels);

}  // namespace shvr
