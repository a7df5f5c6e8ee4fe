#include "engine/annotation/files/mask_import.h"

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/files/mask_source.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/base/error.h"
#include "engine/formats/open_volume.h"

namespace shvr {

std::vector<MaskBrickChange> import_mask(const std::filesystem::path& path, const TraceSpace& space)
{
    if (!states_its_size(path)) return load_mask(path, space.size);
    const std::unique_ptr<VolumeSource> source = open_volume(path);
    check_place(path, "a mask", source->info(), space);
    return mask_changes(*source, path.string());
}

std::string save_mask_as(const std::filesystem::path& path, const Mask& mask, const VolumeInfo& volume,
                         const LabelImage& image, Foreign foreign)
{
    if (is_in_archive(path))
        fail(path.string(),
             ": lies in an archive, which is only read; expected a path outside it that ends in .mask, .nrrd, .tif or "
             ".zarr");
    if (is_mask_export(path)) return export_mask(path, mask, volume, image, {}, {}, foreign);
    if (states_its_size(path))
        fail(path.string(), ": has a format in which masks are only read; expected .mask, .nrrd, .tif or .zarr");
    save_mask(path, mask);
    return {};
}

}  // namespace shvr
