#include "engine/annotation/files/offset_import.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/annotation/files/offset_file.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/annotation/files/voxel_strips.h"
#include "engine/base/error.h"
#include "engine/formats/open_volume.h"
#include "engine/volume/grid.h"
#include "engine/volume/voxel_numbers.h"

namespace shvr {

namespace {

class OffsetReader {
public:
    OffsetReader(const std::filesystem::path& path, const VolumeSource& source, VoxelType type)
        : path_(path), source_(source), type_(type)
    {}

    DensityField read()
    {
        const Size3& size = source_.info().size;
        DensityField field(size, type_);
        const Size3 counts = field.brick_counts();
        const auto voxel_bytes = int64_t(bytes_of(source_.info().type));
        const bool is_small = size.x * size.y <= LAYER_BYTES / (BRICK_SIDE * voxel_bytes);
        const Size3 step = is_small ? Size3(counts.x, counts.y, 1) : Size3(1);
        for (int64_t z = 0; z < counts.z; ++z)
            for (int64_t y = 0; y < counts.y; y += step.y)
                for (int64_t x = 0; x < counts.x; x += step.x) {
                    const Size3 first(x, y, z);
                    read_box({BRICK_SIDE * first, glm::min(BRICK_SIDE * (first + step), size)});
                    for (int64_t i = 0; i < step.x * step.y; ++i) {
                        const Size3 brick = first + Size3(i % step.x, i / step.x, 0);
                        put(field, brick, index_of(brick, counts));
                    }
                }
        return field;
    }

private:
    void read_box(const VoxelBox& box)
    {
        box_ = box;
        const Size3 size = box.size();
        voxels_.resize(size_t(size.x * size.y * size.z) * bytes_of(source_.info().type));
        source_.read(box, voxels_);
    }

    void put(DensityField& field, const Size3& brick, int64_t index)
    {
        const Size3 corner = BRICK_SIDE * brick, extent = glm::min(Size3(BRICK_SIDE), source_.info().size - corner);
        const Size3 in = corner - box_.lower, held = box_.size();
        OffsetBrick offsets{};
        std::vector<double> row(size_t(extent.x));
        for (int64_t z = 0; z < extent.z; ++z)
            for (int64_t y = 0; y < extent.y; ++y) {
                const int64_t from = in.x + held.x * (in.y + y + held.y * (in.z + z));
                load_voxels(source_.info().type, voxels_.data() + size_t(from) * bytes_of(source_.info().type), row);
                for (int64_t x = 0; x < extent.x; ++x)
                    if (row[size_t(x)] != 0.0)
                        offsets[size_t(x + BRICK_SIDE * (y + BRICK_SIDE * z))] =
                            checked(row[size_t(x)], corner + Size3(x, y, z));
            }
        field.put(index, offsets);
    }

    uint32_t checked(double offset, const Size3& voxel) const
    {
        const double limit = offset_limit(type_);
        const bool is_whole = is_float(type_) || std::trunc(offset) == offset;
        if (!(std::abs(offset) <= limit) || !is_whole)
            fail(path_.string(), ": the offset of voxel ", voxel.x, ", ", voxel.y, ", ", voxel.z, " is ", offset,
                 "; expected ", is_float(type_) ? "" : "a whole number from ", -limit, " to ", limit,
                 " for a volume of ", name_of(type_));
        return offset_bits(type_, offset);
    }

    const std::filesystem::path& path_;
    const VolumeSource& source_;
    VoxelType type_;
    VoxelBox box_{};
    std::vector<std::byte> voxels_;
};

}  // namespace

DensityField import_offsets(const std::filesystem::path& path, const TraceSpace& space, VoxelType type)
{
    if (!states_its_size(path)) return load_offsets(path, space.size, type);
    const std::unique_ptr<VolumeSource> source = open_volume(path);
    check_place(path, "a volume of offsets", source->info(), space);
    return OffsetReader(path, *source, type).read();
}

void save_offsets_as(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume)
{
    if (is_offset_export(path)) return export_offsets(path, field, volume);
    if (states_its_size(path))
        fail(path.string(), ": has a format in which offsets are only read; expected .offset, .nrrd or .tif");
    save_offsets(path, field);
}

}  // namespace shvr
