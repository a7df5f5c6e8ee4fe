#include "engine/projects/import_box.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "engine/volume/voxel_dispatch.h"

namespace shvr {
namespace {

/// Bytes that one worker reads at a time from a source without a preferred block size.
constexpr int64_t TASK_BYTES = int64_t{1} << 20;

}  // namespace

ImportBox::ImportBox(const VolumeSource& source, const VoxelBox& box, bool reverses)
    : source_(source), box_(box), reverses_(reverses)
{
    if (!reverses || !is_float(type())) return;
    const VolumeStatistics statistics = measure(source, {.exact = true});
    ends_ = statistics.minimum + statistics.maximum;
}

void ImportBox::read(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const
{
    const VoxelBox wanted{box_.lower + part.lower, box_.lower + part.upper};
    if (block().z == 1) return read_slices(wanted, voxels, pool);
    read_blocks(wanted, voxels, pool);
}

void ImportBox::read_slices(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const
{
    const Size3 extent = part.size();
    const int64_t slice_bytes = extent.x * extent.y * int64_t(bytes_of(type()));
    const int64_t slices = std::clamp<int64_t>(TASK_BYTES / slice_bytes, 1, extent.z);
    pool.run((extent.z + slices - 1) / slices, [&](int64_t task, int /*worker*/) {
        const int64_t lower = task * slices;
        const int64_t upper = std::min(extent.z, lower + slices);
        const std::span<std::byte> to =
            voxels.subspan(size_t(lower * slice_bytes), size_t((upper - lower) * slice_bytes));
        source_.read(
            {{part.lower.x, part.lower.y, part.lower.z + lower}, {part.upper.x, part.upper.y, part.lower.z + upper}},
            to);
        reverse(to);
    });
}

/// Whole blocks along z and y, so that nothing is decoded twice.
void ImportBox::read_blocks(const VoxelBox& box, std::span<std::byte> voxels, WorkPool& pool) const
{
    const Size3 extent = box.size();
    const int64_t row_bytes = extent.x * int64_t(bytes_of(type()));
    const int64_t slice_bytes = row_bytes * extent.y;
    const Size3 block = this->block();
    const int64_t first_z = box.lower.z / block.z;
    const int64_t first_y = box.lower.y / block.y;
    const int64_t along_z = (box.upper.z - 1) / block.z - first_z + 1;
    const int64_t along_y = (box.upper.y - 1) / block.y - first_y + 1;
    pool.run(along_z * along_y, [&](int64_t task, int /*worker*/) {
        const int64_t z = first_z + task / along_y;
        const int64_t y = first_y + task % along_y;
        const VoxelBox part{glm::max(box.lower, Size3(0, y * block.y, z * block.z)),
                            glm::min(box.upper, Size3(box.upper.x, (y + 1) * block.y, (z + 1) * block.z))};
        const auto part_bytes = size_t(row_bytes * part.size().y);
        std::vector<std::byte> read(part_bytes * size_t(part.size().z));
        source_.read(part, read);
        reverse(read);
        for (int64_t slice = 0; slice < part.size().z; ++slice) {
            const int64_t to =
                (part.lower.z - box.lower.z + slice) * slice_bytes + (part.lower.y - box.lower.y) * row_bytes;
            std::memcpy(voxels.data() + to, read.data() + size_t(slice) * part_bytes, part_bytes);
        }
    });
}

void ImportBox::reverse(std::span<std::byte> voxels) const
{
    if (!reverses_) return;
    with_voxel_type(type(), [&]<class T>(T) {
        for (T& voxel : std::span(reinterpret_cast<T*>(voxels.data()), voxels.size() / sizeof(T))) {
            if constexpr (std::is_floating_point_v<T>) {
                voxel = static_cast<T>(ends_ - double(voxel));
            } else {
                voxel = static_cast<T>(~voxel);  // = smallest + largest - voxel
            }
        }
    });
}

}  // namespace shvr
