#include "engine/annotation/files/brick_boxes.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "engine/volume/voxel_walk.h"

namespace shvr {

namespace {

/// Size limit of a box that contains more than one brick.
constexpr int64_t BOX_BYTES = int64_t{64} << 20;

/// Returns the size of a box: the size of a stored block if the block is small and consists of whole bricks (so that no
/// block is decoded twice); otherwise a layer of bricks if that is small, otherwise one brick.
Size3 box_size(const VolumeSource& source)
{
    const auto voxel_bytes = int64_t(bytes_of(source.info().type));
    const Size3 block = source.block(), whole = BRICK_SIDE * brick_grid(source.info().size);
    const auto is_small = [&](const Size3& box) {  // each side is at most 2^20
        return box.x * box.y <= BOX_BYTES / voxel_bytes && box.x * box.y * box.z <= BOX_BYTES / voxel_bytes;
    };
    if (block % BRICK_SIDE == Size3(0) && is_small(glm::min(block, whole))) return glm::min(block, whole);
    const Size3 layer(whole.x, whole.y, BRICK_SIDE);
    return is_small(layer) ? layer : Size3(BRICK_SIDE);
}

/// The indices of the boxes that stored blocks touch, ascending; null if the source does not list its stored blocks.
std::optional<std::vector<int64_t>> touched_boxes(const VolumeSource& source, const Size3& box, const Size3& counts)
{
    constexpr size_t MAX_REPEATED = size_t{1} << 22;
    const std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_STORED_BLOCKS);
    if (!stored || stored->fill != 0.0) return std::nullopt;
    std::vector<int64_t> boxes;
    size_t kept = 0;  // sorted, each once
    const auto merge = [&] {
        std::ranges::sort(boxes);
        const auto repeated = std::ranges::unique(boxes);
        boxes.erase(repeated.begin(), repeated.end());
        kept = boxes.size();
    };
    for (const glm::ivec3& block : stored->blocks) {
        const VoxelBox voxels = box_of_block(*stored, block, source.info().size);
        const Size3 first = voxels.lower / box, end = (voxels.upper - int64_t{1}) / box + int64_t{1};
        Size3 at;
        for (at.z = first.z; at.z < end.z; ++at.z)
            for (at.y = first.y; at.y < end.y; ++at.y)
                for (at.x = first.x; at.x < end.x; ++at.x) boxes.push_back(index_of(at, counts));
        if (boxes.size() > 2 * kept + MAX_REPEATED) merge();
    }
    merge();
    return boxes;
}

}  // namespace

void for_each_brick_box(const VolumeSource& source, const std::function<void(const VoxelBox& box)>& visit)
{
    const Size3 size = source.info().size, box = box_size(source);
    const Size3 counts = (size - int64_t{1}) / box + int64_t{1};
    const auto visit_box = [&](int64_t number) {
        const Size3 lower = box * position_of(number, counts);
        visit({lower, glm::min(lower + box, size)});
    };
    if (const std::optional<std::vector<int64_t>> touched = touched_boxes(source, box, counts))
        std::ranges::for_each(*touched, visit_box);
    else
        for (int64_t number = 0; number < counts.x * counts.y * counts.z; ++number) visit_box(number);
}

}  // namespace shvr
