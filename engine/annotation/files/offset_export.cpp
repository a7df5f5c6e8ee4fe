#include "engine/annotation/files/offset_export.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/annotation/files/offset_file.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/export/volume_export.h"
#include "engine/volume/grid.h"

namespace shvr {

namespace {

VoxelType exported_type(VoxelType type)
{
    return bytes_of(type) == 4 && !is_float(type) ? VoxelType::int32 : VoxelType::float32;
}

/// The offsets as a volume.
class FieldSource final : public VolumeSource {
public:
    FieldSource(const DensityField& field, const VolumeInfo& volume)
        : VolumeSource(info_beside(volume, "offsets", exported_type(field.type()))), field_(field)
    {
        SHVR_CHECK(field.size() == volume.size);
    }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const glm::i64vec3 counts = field_.brick_counts();
        std::byte* to = voxels.data();
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x;) {
                    const int64_t end = std::min(box.upper.x, (x / BRICK_SIDE + 1) * BRICK_SIDE);
                    const auto brick = field_.brick(index_of(Size3(x, y, z) / BRICK_SIDE, counts));
                    const auto row = size_t(BRICK_SIDE * (y % BRICK_SIDE + BRICK_SIDE * (z % BRICK_SIDE)));
                    for (; x < end; ++x, to += sizeof(uint32_t))
                        put(brick ? (*brick)[row + size_t(x % BRICK_SIDE)] : 0, to);
                }
    }

private:
    void put(uint32_t bits, std::byte* to) const
    {
        if (info().type == VoxelType::float32) bits = std::bit_cast<uint32_t>(float(offset_of(field_.type(), bits)));
        std::memcpy(to, &bits, sizeof bits);
    }
    const DensityField& field_;
};

bool is_bare(const std::filesystem::path& path)
{
    return lower_case(path.extension().string()) == ".offset";
}

}  // namespace

bool is_offset_export(const std::filesystem::path& path)
{
    return is_bare(path) || is_volume_export(path);
}

void export_offsets(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume,
                    const Progress& progress)
{
    if (!is_offset_export(path))
        fail(path.string(), ": has the extension ", in_quotes(path.extension().string()),
             "; expected .offset, .nrrd or .tif");
    if (is_bare(path)) return save_offsets(path, field, progress);
    export_volume(path, FieldSource(field, volume), progress);
}

}  // namespace shvr
