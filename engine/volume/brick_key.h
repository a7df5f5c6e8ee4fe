#pragma once
// Identifies a brick: its level and its position in that level's grid of bricks.

#include <cstddef>
#include <functional>

#include "engine/volume/volume.h"
#include "shaders/bricks.h"

namespace shvr {

struct BrickKey {
    int level = 0;
    glm::ivec3 brick{0};  ///< position in bricks of gpu::BRICK_SIZE voxels a side; at most 2^15 along each axis
    bool operator==(const BrickKey&) const = default;
};

struct BrickKeyHash {
    size_t operator()(const BrickKey& key) const
    {
        const auto x = size_t(key.brick.x), y = size_t(key.brick.y), z = size_t(key.brick.z);
        return std::hash<size_t>{}((x | y << 16 | z << 32 | size_t(key.level) << 48) * 0x9e3779b97f4a7c15ull);
    }
};

/// Returns the brick of the next coarser level that contains this brick.
inline BrickKey parent_of(const BrickKey& key)
{
    return {key.level + 1, key.brick / 2};
}

/// Returns the voxels of level 0 that the brick covers, clipped to the volume.
inline VoxelBox voxels_of(const BrickKey& key, const Size3& size)
{
    const int64_t side = int64_t{gpu::BRICK_SIZE} << key.level;
    return {side * Size3(key.brick), glm::min(side * (Size3(key.brick) + int64_t{1}), size)};
}

/// Calls visit(key) for a brick and its 26 neighbours, also for neighbours outside the volume.
template <class Visit>
void for_each_around(const BrickKey& key, const Visit& visit)
{
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) visit(BrickKey{key.level, key.brick + glm::ivec3(x, y, z)});
}

}  // namespace shvr
