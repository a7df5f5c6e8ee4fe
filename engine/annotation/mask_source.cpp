#include "engine/annotation/mask_source.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"

namespace shvr {

namespace {

constexpr int64_t SIDE = gpu::BRICK_SIZE;
/// A layer of bricks is read at once where it is no larger, else brick by brick.
constexpr int64_t LAYER_BYTES = int64_t{64} << 20;

VolumeInfo info_of(const Mask& mask, const VolumeInfo& volume)
{
    SHVR_CHECK(mask.size() == volume.size);
    VolumeInfo info = volume;
    info.name = "mask";
    info.format = "mask";
    info.type = VoxelType::uint8;
    info.warnings.clear();
    return info;
}

}  // namespace

MaskSource::MaskSource(const Mask& mask, const VolumeInfo& volume) : VolumeSource(info_of(mask, volume)), mask_(mask) {}

void MaskSource::read(const VoxelBox& box, std::span<std::byte> voxels) const
{
    const glm::i64vec3 counts = mask_.brick_counts();
    std::byte* row = voxels.data();
    for (int64_t z = box.lower.z; z < box.upper.z; ++z)
        for (int64_t y = box.lower.y; y < box.upper.y; ++y, row += box.size().x)
            for (int64_t x = box.lower.x; x < box.upper.x;) {
                const int64_t end = std::min(box.upper.x, (x / SIDE + 1) * SIDE);
                const MaskBrick* brick = mask_.brick(x / SIDE + counts.x * (y / SIDE + counts.y * (z / SIDE)));
                auto* const to = reinterpret_cast<uint8_t*>(row + (x - box.lower.x));
                if (brick)
                    std::copy_n(brick->data() + x % SIDE + SIDE * (y % SIDE + SIDE * (z % SIDE)), end - x, to);
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
    const glm::i64vec3 counts = (info.size + Size3(SIDE - 1)) / Size3(SIDE);
    const bool is_small = info.size.x * info.size.y <= LAYER_BYTES / SIDE;
    const int64_t at_once = is_small ? counts.x * counts.y : 1;
    std::vector<MaskBrickChange> changes;
    std::vector<uint8_t> voxels;
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; brick += at_once) {
        const Size3 place(brick % counts.x, brick / counts.x % counts.y, brick / (counts.x * counts.y));
        const Size3 first = SIDE * place;
        const Size3 wanted = is_small ? Size3(info.size.x, info.size.y, SIDE) : Size3(SIDE);
        const VoxelBox box{first, glm::min(first + wanted, info.size)};
        const Size3 size = box.size();
        voxels.resize(size_t(size.x * size.y * size.z));
        groups.read(box, std::as_writable_bytes(std::span(voxels)));
        if (std::ranges::all_of(voxels, [](uint8_t group) { return group == 0; })) continue;
        for (int64_t i = 0; i < at_once; ++i) {
            const Size3 inner = SIDE * Size3(i % counts.x, i / counts.x, 0) * int64_t{is_small};
            MaskBrickChange change{brick + i, {}};
            const Size3 extent = glm::min(Size3(SIDE), size - inner);
            for (int64_t z = 0; z < extent.z; ++z)
                for (int64_t y = 0; y < extent.y; ++y) {
                    const int64_t from = inner.x + size.x * (inner.y + y + size.y * z);
                    append_painted_runs(change.runs, std::span(voxels).subspan(size_t(from), size_t(extent.x)),
                                        size_t(SIDE * (y + SIDE * z)));
                }
            if (!change.runs.empty()) changes.push_back(std::move(change));
        }
    }
    return changes;
}

}  // namespace shvr
