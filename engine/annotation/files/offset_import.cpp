#include "engine/annotation/files/offset_import.h"

#include <cmath>
#include <vector>

#include "engine/annotation/files/brick_boxes.h"
#include "engine/annotation/files/offset_file.h"
#include "engine/annotation/files/volume_place.h"
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
        const VolumeInfo& info = source_.info();
        DensityField field(info.size, type_);
        for_each_brick_box(source_, [&](const VoxelBox& box) {
            const Size3 size = box.size();
            voxels_.resize(size_t(size.x * size.y * size.z) * bytes_of(info.type));
            source_.read(box, voxels_);
            for_each_brick(box, info.size, [&](const BrickOfBox& brick) { put(field, brick); });
        });
        return field;
    }

private:
    void put(DensityField& field, const BrickOfBox& brick)
    {
        const VoxelType type = source_.info().type;
        OffsetBrick offsets{};
        std::vector<double> row(size_t(brick.extent.x));
        for (int64_t z = 0; z < brick.extent.z; ++z)
            for (int64_t y = 0; y < brick.extent.y; ++y) {
                load_voxels(type, voxels_.data() + size_t(brick.row(y, z)) * bytes_of(type), row);
                for (int64_t x = 0; x < brick.extent.x; ++x)
                    if (row[size_t(x)] != 0.0)
                        offsets[size_t(x + BRICK_SIDE * (y + BRICK_SIDE * z))] =
                            checked(row[size_t(x)], brick.corner + Size3(x, y, z));
            }
        field.put(brick.index, offsets);
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

std::string save_offsets_as(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume,
                            Foreign foreign, const Progress& progress)
{
    if (is_offset_export(path)) return export_offsets(path, field, volume, progress, foreign);
    if (states_its_size(path))
        fail(path.string(), ": has a format in which offsets are only read; expected .offset, .nrrd, .tif or .zarr");
    save_offsets(path, field, progress);
    return {};
}

}  // namespace shvr
