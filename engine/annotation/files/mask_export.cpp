#include "engine/annotation/files/mask_export.h"

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/files/mask_segments.h"
#include "engine/annotation/files/mask_source.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/export/volume_export.h"

namespace shvr {

namespace {

bool is_nrrd(const std::filesystem::path& path)
{
    return lower_case(path.extension().string()) == ".nrrd";
}

}  // namespace

bool is_mask_export(const std::filesystem::path& path)
{
    return is_label_image(path) || is_volume_export(path) || lower_case(path.extension().string()) == ".mask";
}

std::string export_mask(const std::filesystem::path& path, const Mask& mask, const VolumeInfo& volume,
                        const LabelImage& image, std::optional<OmeZarrVersion> version, const Progress& progress,
                        Foreign foreign)
{
    if (!is_mask_export(path))
        fail(path.string(), ": has the extension ", in_quotes(path.extension().string()),
             "; expected .mask, .nrrd, .tif or .zarr");
    const MaskSource groups(mask, volume);
    const std::optional<NrrdHead> header = header_to_keep(path, image.header);
    if (is_label_image(path)) {
        LabelImage described = image;
        described.header = header;
        return save_label_image(
            groups, path, described,
            {.version = version, .progress = [&](const ImportProgress& done) { tell(progress, done.fraction); }},
            foreign);
    }
    if (is_nrrd(path)) {
        NrrdHead head = header.value_or(NrrdHead{});
        describe_segments(head, path, mask, image.colors);
        export_volume(path, groups, progress, head);
    } else if (is_volume_export(path)) {
        export_volume(path, groups, progress);
    } else {
        save_mask(path, mask, progress);
    }
    return {};
}

}  // namespace shvr
