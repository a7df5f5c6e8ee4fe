#pragma once
// The voxels of a brick that belong to a set, one bit each.

#include <array>
#include <bit>
#include <cstring>
#include <span>

#include "engine/annotation/mask.h"

namespace shvr {

/// One 32-bit word for each row along x: voxel (x, y, z) of the brick is bit x of word y + 32 z.
using BrickBits = std::array<uint32_t, VOXELS_PER_BRICK / BRICK_SIDE>;
static_assert(BRICK_SIDE == 32);

/// Which of eight voxels have the group, one bit each. Works on all at once: the high bit of a byte is cleared where
/// the byte equals the group, and a product collects the high bits.
inline uint32_t equal_in_eight(const uint8_t* voxels, uint8_t group)
{
    static_assert(std::endian::native == std::endian::little);
    constexpr uint64_t ONES = 0x0101010101010101u, LOW = 0x7f * ONES;
    uint64_t word = 0;
    std::memcpy(&word, voxels, sizeof(word));
    word ^= group * ONES;
    const uint64_t differs = ((word & LOW) + LOW) | word;
    return uint32_t((~differs >> 7 & ONES) * 0x0102040810204080u >> 56);
}

/// The end of the run of voxels from `first` on, at most `end`, that have the group of the first.
inline size_t end_of_run(const MaskBrick& brick, size_t first, size_t end)
{
    const uint8_t group = brick[first];
    for (; first + 8 <= end; first += 8)
        if (const uint32_t equal = equal_in_eight(&brick[first], group); equal != 0xff)
            return first + size_t(std::countr_one(equal));
    while (first < end && brick[first] == group) ++first;
    return first;
}

/// The voxels of one group.
inline BrickBits bits_of(const MaskBrick& brick, uint8_t group)
{
    BrickBits bits{};
    for (size_t row = 0; row < bits.size(); ++row)
        for (size_t x = 0; x < 32; x += 8) bits[row] |= equal_in_eight(&brick[32 * row + x], group) << x;
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

inline bool is_empty(std::span<const uint32_t> bits)
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
