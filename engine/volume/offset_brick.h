#pragma once
// Density offsets: values that a user adds to single voxels to make them visible. They are stored separately from the
// volume, in bricks of 32^3, and are added when voxels are read (offset_source.h). The volume's file is never written.
//
// An offset has 32 bits: for integer volumes an int32, which is exact; for float volumes a float. In both, all bits 0
// means "none"; -0 does not occur. Any thread may call these functions.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "engine/volume/volume.h"
#include "shaders/bricks.h"

namespace shvr {

using OffsetBrick = std::array<uint32_t, size_t{gpu::BRICK_SIZE} * gpu::BRICK_SIZE * gpu::BRICK_SIZE>;  ///< x fastest

/// The largest magnitude of an offset: enough to turn any value of the type into any other. Exceptions: 32-bit types,
/// where it is half of the type's span, and float64, where it is the largest float.
double offset_limit(VoxelType type);

inline double offset_of(VoxelType type, uint32_t bits)
{
    return is_float(type) ? double(std::bit_cast<float>(bits)) : double(std::bit_cast<int32_t>(bits));
}

/// Rounds an offset to nearest (integers: halves away from 0) and clamps it to the limit. `offset` must not be NaN.
uint32_t offset_bits(VoxelType type, double offset);

}  // namespace shvr
