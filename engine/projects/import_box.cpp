#include "engine/projects/import_box.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "engine/volume/voxel_dispatch.h"
#include "engine/volume/voxel_walk.h"

namespace shvr {
namespace {

/// Size of the pieces in which a worker reads from a source that has no preferred block size.
constexpr int64_t TASK_BYTES = int64_t{1} << 20;

/// Returns the smallest and the largest finite value of level 0, or 0 and 0 if no voxel is finite. Reads all voxels: a
/// sample or coarser level could miss an extreme, whose reversed value would then not fit into the type.
ValueRange ends_of(const VolumeSource& source, const Progress& progress)
{
    const VolumeInfo& info = source.info();
    std::optional<StoredBlocks> stored = source.stored_blocks(0, MAX_STORED_BLOCKS);
    const VoxelWalk walk = stored ? VoxelWalk::stored(source, *std::move(stored)) : VoxelWalk::all(source);
    return with_voxel_type(info.type, [&]<class T>(T) {
        T lower = std::numeric_limits<T>::max(), upper = std::numeric_limits<T>::lowest();
        const auto look_at = [&](T voxel) {
            if constexpr (std::is_floating_point_v<T>)
                if (!std::isfinite(voxel)) return;
            lower = std::min(lower, voxel);
            upper = std::max(upper, voxel);
        };
        if (walk.rest() > 0) look_at(static_cast<T>(walk.fill()));
        std::vector<T> voxels;
        for (int64_t i = 0; i < walk.boxes(); ++i) {
            tell(progress, double(i) / double(walk.boxes()));
            const Size3 extent = walk.box(i).size();
            voxels.resize(size_t(extent.x * extent.y * extent.z));
            source.read(walk.box(i), std::as_writable_bytes(std::span(voxels)));
            for (const T voxel : voxels) look_at(voxel);
        }
        return lower > upper ? ValueRange{} : ValueRange{double(lower), double(upper)};
    });
}

}  // namespace

ImportBox::ImportBox(const VolumeSource& source, const VoxelBox& box, bool reverses, const Progress& progress)
    : source_(source), box_(box), reverses_(reverses)
{
    if (!reverses) return;
    const ValueRange ends = ends_of(source, progress);
    ends_ = ends.lower + ends.upper;  // exact for integers of 32 bits
}

void ImportBox::read(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const
{
    const VoxelBox wanted{box_.lower + part.lower, box_.lower + part.upper};
    if (block().z == 1) return read_slices(wanted, voxels, pool);
    read_blocks(wanted, voxels, pool);
}

double ImportBox::bytes(const Size3& extent, int workers) const
{
    const Size3 block = this->block();
    if (block == Size3(1)) return 0.0;
    const auto voxel_bytes = double(bytes_of(type()));
    const double decoded = voxels_in(block) * voxel_bytes;
    const double blocks = voxels_in((source_.info().size + block - int64_t{1}) / block);
    const double held =
        block.z == 1 ? 0.0 : voxels_in(glm::min(extent, Size3(extent.x, block.y, block.z))) * voxel_bytes;
    // During decoding, memory holds a block three times: as stored, as decoded, and in the order of the volume.
    return std::min(SOURCE_CACHE_BYTES, blocks * decoded) + double(workers) * (3.0 * decoded + held);
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

/// Reads boxes of whole blocks along z and y, so that no block is decoded twice.
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
            voxel = static_cast<T>(ends_ - double(voxel));
        }
    });
}

}  // namespace shvr
