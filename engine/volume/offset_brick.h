#pragma once
// Density offsets: values that a user adds to single voxels to make them visible. They are stored separately from the
// volume, in bricks of 32^3, and added when voxels are read (offset_source.h); the volume's own file is never written.
//
// An offset has 32 bits: an int32 for integer volumes, which is exact, and a float for float volumes. All bits 0 means
// "none" for both; -0 does not occur. Any thread may call these.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "engine/volume/volume.h"
#include "shaders/bricks.h"

namespace shvr {

using OffsetBrick = std::array<uint32_t, size_t{gpu::BRICK_SIZE} * gpu::BRICK_SIZE * gpu::BRICK_SIZE>;  ///< x fastest

/// The largest magnitude of an offset: enough to turn any value of the type into any other (32-bit types: half of that;
/// float64: the largest float).
double offset_limit(VoxelType type);

inline double offset_of(VoxelType type, uint32_t bits)
{
    return is_float(type) ? double(std::bit_cast<float>(bits)) : double(std::bit_cast<int32_t>(bits));
}

/// Rounded to nearest (integers: halves away from 0) and clamped to the limit. `offset` is not NaN.
uint32_t offset_bits(VoxelType type, double offset);

}  // namespace shvr
