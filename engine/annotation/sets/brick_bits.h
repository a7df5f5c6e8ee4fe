#pragma once
// The voxels of a brick that belong to a set, one bit each.

#include <array>
#include <bit>

#include "engine/annotation/mask.h"

namespace shvr {

/// One 32-bit word for each row along x: voxel (x, y, z) of the brick is bit x of word y + 32 z.
using BrickBits = std::array<uint32_t, VOXELS_PER_BRICK / BRICK_SIDE>;
static_assert(BRICK_SIDE == 32);

/// The voxels of one group.
inline BrickBits bits_of(const MaskBrick& brick, uint8_t group)
{
    BrickBits bits{};
    for (size_t row = 0; row < bits.size(); ++row) {
        uint32_t word = 0;
        for (size_t x = 0; x < 32; ++x) word |= uint32_t(brick[32 * row + x] == group) << x;
        bits[row] = word;
    }
    return bits;
}

/// The voxels of a brick that lie inside the volume; `extent` is the size of the brick's part inside the volume.
inline BrickBits bits_inside(const Size3& extent)
{
    BrickBits bits{};
    for (int64_t z = 0; z < extent.z; ++z)
        for (int64_t y = 0; y < extent.y; ++y) bits[size_t(y + 32 * z)] = ~0u >> (32 - extent.x);
    return bits;
}

inline bool is_empty(const BrickBits& bits)
{
    for (const uint32_t word : bits)
        if (word != 0) return false;
    return true;
}

inline int64_t count_of(const BrickBits& bits)
{
    int64_t count = 0;
    for (const uint32_t word : bits) count += std::popcount(word);
    return count;
}

}  // namespace shvr
