#pragma once
// Arithmetic on grids of voxels, bricks and chunks (x fastest) and on boxes of voxels. Pure functions; any thread.

#include "engine/volume/volume.h"
#include "shaders/bricks.h"

namespace shvr {

/// Voxels along one side of a brick.
inline constexpr int64_t BRICK_SIDE = gpu::BRICK_SIZE;
/// The largest accepted side of a volume, in voxels.
inline constexpr int64_t MAX_SIDE = int64_t{1} << 20;

/// Returns the number of bricks along each axis of a volume of `size` voxels.
inline Size3 brick_grid(const Size3& size)
{
    return (size + (BRICK_SIDE - 1)) / BRICK_SIDE;
}

inline int64_t index_of(const Size3& position, const Size3& counts)
{
    return position.x + counts.x * (position.y + counts.y * position.z);
}

inline Size3 position_of(int64_t index, const Size3& counts)
{
    return {index % counts.x, index / counts.x % counts.y, index / (counts.x * counts.y)};
}

/// Returns the smallest box that contains both boxes.
inline VoxelBox united(const VoxelBox& a, const VoxelBox& b)
{
    return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}

/// Whether the boxes share a voxel.
inline bool meet(const VoxelBox& a, const VoxelBox& b)
{
    return glm::all(glm::lessThan(a.lower, b.upper)) && glm::all(glm::lessThan(b.lower, a.upper));
}

inline VoxelBox grown(const VoxelBox& box, int64_t voxels)
{
    return {box.lower - voxels, box.upper + voxels};
}

}  // namespace shvr
