#include "engine/annotation/files/offset_export.h"

#include <bit>

#include "engine/annotation/files/offset_file.h"
#include "engine/annotation/files/sparse_source.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/export/volume_export.h"

namespace shvr {

namespace {

VoxelType exported_type(VoxelType type)
{
    return bytes_of(type) == 4 && !is_float(type) ? VoxelType::int32 : VoxelType::float32;
}

/// Presents the offsets as a volume of 32-bit integers or floats.
class FieldSource final : public SparseSource<uint32_t> {
public:
    FieldSource(const DensityField& field, const VolumeInfo& volume, VoxelType type)
        : SparseSource(field, info_beside(volume, "offsets", type)),
          of_(field.type()),
          is_converted_(is_float(type) && !is_float(of_))
    {}

private:
    uint32_t shown(uint32_t bits) const override
    {
        return is_converted_ ? std::bit_cast<uint32_t>(float(offset_of(of_, bits))) : bits;
    }

    VoxelType of_;
    bool is_converted_;
};

bool is_bare(const std::filesystem::path& path)
{
    return lower_case(path.extension().string()) == ".offset";
}

bool is_sparse(const std::filesystem::path& path)
{
    const std::filesystem::path plain = path.has_filename() ? path : path.parent_path();
    return lower_case(plain.extension().string()) == ".zarr";
}

}  // namespace

bool is_offset_export(const std::filesystem::path& path)
{
    return is_bare(path) || is_sparse(path) || is_volume_export(path);
}

std::string export_offsets(const std::filesystem::path& path, const DensityField& field, const VolumeInfo& volume,
                           const Progress& progress, Foreign foreign)
{
    if (!is_offset_export(path))
        fail(path.string(), ": has the extension ", in_quotes(path.extension().string()),
             "; expected .offset, .nrrd, .tif or .zarr");
    if (is_sparse(path)) {
        const VoxelType type = is_float(field.type()) ? VoxelType::float32 : VoxelType::int32;
        return save_number_image(FieldSource(field, volume, type), path, "offsets", progress, foreign);
    }
    if (is_bare(path))
        save_offsets(path, field, progress);
    else
        export_volume(path, FieldSource(field, volume, exported_type(field.type())), progress);
    return {};
}

}  // namespace shvr
