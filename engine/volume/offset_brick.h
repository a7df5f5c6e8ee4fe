#pragma once
// Density offsets: values that a user adds to single voxels to make them visible. They are stored separately from the
// volume, in bricks of 32^3, and are added when voxels are read (offset_source.h). The volume's file is never changed.
//
// An offset has 32 bits: an int32 for integer volumes, where it is exact, and a float for float volumes. In both cases,
// all bits 0 mean "no offset"; -0 does not occur. Any thread may call these functions.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "engine/volume/volume.h"
#include "shaders/bricks.h"

namespace shvr {

using OffsetBrick = std::array<uint32_t, size_t{gpu::BRICK_SIZE} * gpu::BRICK_SIZE * gpu::BRICK_SIZE>;  ///< x fastest

/// Returns the largest magnitude of an offset, which can turn any value of the type into any other. Exceptions: for
/// 32-bit types half of the type's span, and for float64 the largest float.
double offset_limit(VoxelType type);

inline double offset_of(VoxelType type, uint32_t bits)
{
    return is_float(type) ? double(std::bit_cast<float>(bits)) : double(std::bit_cast<int32_t>(bits));
}

/// Rounds an offset to nearest (for integers, halves away from 0) and clamps it to the limit. `offset` must not be NaN.
uint32_t offset_bits(VoxelType type, double offset);

}  // namespace shvr
