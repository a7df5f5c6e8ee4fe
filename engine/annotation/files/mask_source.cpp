#include "engine/annotation/files/mask_source.h"

#include <algorithm>
#include <utility>

#include "engine/annotation/files/volume_place.h"
#include "engine/annotation/files/voxel_strips.h"
#include "engine/base/error.h"
#include "engine/volume/grid.h"

namespace shvr {

MaskSource::MaskSource(const Mask& mask, const VolumeInfo& volume)
    : VolumeSource(info_beside(volume, "mask", VoxelType::uint8)), mask_(mask)
{
    SHVR_CHECK(mask.size() == volume.size);
}

void MaskSource::read(const VoxelBox& box, std::span<std::byte> voxels) const
{
    const glm::i64vec3 counts = mask_.brick_counts();
    std::byte* row = voxels.data();
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y, row += box.size().x)
            for (int64_t x = box.lower.x; x < box.upper.x;) {
                const int64_t end = std::min(box.upper.x, (x / BRICK_SIDE + 1) * BRICK_SIDE);
                const MaskBrick* brick = mask_.brick(index_of(Size3(x, y, z) / BRICK_SIDE, counts)).get();
                auto* const to = reinterpret_cast<uint8_t*>(row + (x - box.lower.x));
                if (brick)
                    std::copy_n(
                        brick->data() + x % BRICK_SIDE + BRICK_SIDE * (y % BRICK_SIDE + BRICK_SIDE * (z % BRICK_SIDE)),
                        end - x, to);
                else
                    std::fill_n(to, end - x, uint8_t{0});
                x = end;
            }
}

std::vector<MaskBrickChange> mask_changes(const VolumeSource& groups, const std::string& file)
{
    const VolumeInfo& info = groups.info();
    if (info.type != VoxelType::uint8)
        fail(file, ": holds voxels of type ", name_of(info.type), "; expected uint8, colour groups");
    const glm::i64vec3 counts = (info.size + Size3(BRICK_SIDE - 1)) / Size3(BRICK_SIDE);
    const bool is_small = info.size.x * info.size.y <= LAYER_BYTES / BRICK_SIDE;
    const int64_t at_once = is_small ? counts.x * counts.y : 1;
    std::vector<MaskBrickChange> changes;
    std::vector<uint8_t> voxels;
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; brick += at_once) {
        const Size3 place = position_of(brick, counts);
        const Size3 first = BRICK_SIDE * place;
        const Size3 wanted = is_small ? Size3(info.size.x, info.size.y, BRICK_SIDE) : Size3(BRICK_SIDE);
        const VoxelBox box{first, glm::min(first + wanted, info.size)};
        const Size3 size = box.size();
        voxels.resize(size_t(size.x * size.y * size.z));
        groups.read(box, std::as_writable_bytes(std::span(voxels)));
        if (std::ranges::all_of(voxels, [](uint8_t group) { return group == 0; })) continue;
        for (int64_t i = 0; i < at_once; ++i) {
            const Size3 inner = BRICK_SIDE * Size3(i % counts.x, i / counts.x, 0) * int64_t{is_small};
            MaskBrickChange change{brick + i, {}};
            const Size3 extent = glm::min(Size3(BRICK_SIDE), size - inner);
            for (int64_t z = 0; z < extent.z; ++z)
                for (int64_t y = 0; y < extent.y; ++y) {
                    const int64_t from = inner.x + size.x * (inner.y + y + size.y * z);
                    append_painted_runs(change.runs, std::span(voxels).subspan(size_t(from), size_t(extent.x)),
                                        size_t(BRICK_SIDE * (y + BRICK_SIDE * z)));
                }
            if (!change.runs.empty()) changes.push_back(std::move(change));
        }
    }
    return changes;
}

}  // namespace shvr
