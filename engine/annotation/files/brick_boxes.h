#pragma once
// Divides a volume of annotation into boxes, to read it from a file box by box. Boxes consist of whole bricks and do
// not overlap; boxes without stored data are skipped.

#include <cstdint>
#include <functional>

#include "engine/volume/grid.h"
#include "engine/volume/source.h"

namespace shvr {

/// Calls `visit` for boxes of whole bricks, clipped to the volume. A box has at most 64 MiB unless it is a single
/// brick. If the source lists its stored blocks, and all other voxels are 0, skips boxes without a stored block; the
/// cost then does not depend on the volume's size. Fails if `stored_blocks` fails.
void for_each_brick_box(const VolumeSource& source, const std::function<void(const VoxelBox& box)>& visit);

struct BrickOfBox {
    int64_t index;  ///< among the volume's bricks
    Size3 corner;   ///< its first voxel, in the volume
    Size3 extent;   ///< its voxels in the volume
    int64_t voxel;  ///< index, in the box, of the brick's first voxel
    Size3 box;      ///< voxels of the box
    /// Index, in the box, of the first voxel of a row (y, z) of the brick.
    int64_t row(int64_t y, int64_t z) const { return voxel + box.x * (y + box.y * z); }
};

/// Calls `visit` for each brick of a box of whole bricks, in a volume of `size` voxels.
template <class Visit>
void for_each_brick(const VoxelBox& box, const Size3& size, const Visit& visit)
{
    const Size3 first = box.lower / BRICK_SIDE, end = brick_grid(box.upper);
    Size3 at;
    for (at.z = first.z; at.z < end.z; ++at.z)
        for (at.y = first.y; at.y < end.y; ++at.y)
            for (at.x = first.x; at.x < end.x; ++at.x) {
                const Size3 corner = BRICK_SIDE * at;
                visit(BrickOfBox{.index = index_of(at, brick_grid(size)),
                                 .corner = corner,
                                 .extent = glm::min(Size3(BRICK_SIDE), size - corner),
                                 .voxel = index_of(corner - box.lower, box.size()),
                                 .box = box.size()});
            }
}

}  // namespace shvr
