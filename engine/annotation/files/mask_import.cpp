#include "engine/annotation/files/mask_import.h"

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/files/mask_place.h"
#include "engine/annotation/files/mask_segments.h"
#include "engine/annotation/files/mask_source.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/choice.h"
#include "engine/formats/nrrd_head.h"
#include "engine/formats/open_volume.h"

namespace shvr {

namespace {

/// Number of layers of a segmentation; 0 if the file is not a segmentation or has only one layer.
int64_t layers_of(const std::filesystem::path& path, const std::vector<NrrdSegment>& segments)
{
    if (segments.empty()) return 0;
    try {
        static_cast<void>(open_volume(path));
    } catch (const ChoiceNeeded& needed) {
        for (const Choice& choice : needed.choices())
            if (choice.key == "channel") return int64_t(choice.values.size());
        throw;
    }
    return 0;
}

std::string renumbered_in_words(const std::vector<NrrdSegment>& segments)
{
    std::string words;
    for (const NrrdSegment& segment : segments)
        if (segment.group != segment.label_value)
            words += sentence(words.empty() ? "; " : ", ", in_quotes(segment.name), " of value ", segment.label_value,
                              " becomes group ", segment.group);
    return words;
}

/// Converts the mask in `source` to changes of `mask`, placed as the file at `path` states.
void take_placed(const VolumeSource& source, const std::filesystem::path& path, const TraceSpace& space,
                 ImportedMask& mask)
{
    const std::optional<GridPlace> place = place_of_mask(path, source.info(), space);
    if (!place) {
        check_place(path, "a mask", source.info(), space);
        mask.changes = mask_changes(source, path.string());
        return;
    }
    const PlacedSource placed(source, *place, space);
    placed.expect_nothing_outside(path);
    mask.changes = mask_changes(placed, path.string());
    mask.remarks.push_back(sentence(path.string(), ": ", in_words(*place, source.info().size, space)));
}

}  // namespace

ImportedMask import_mask(const std::filesystem::path& path, const TraceSpace& space)
{
    ImportedMask mask;
    if (!states_its_size(path)) {
        mask.changes = load_mask(path, space.size);
        return mask;
    }
    const std::vector<NrrdSegment> segments = segments_of(read_nrrd_head(path).value_or(NrrdHead{}));
    const int64_t layers = layers_of(path, segments);
    if (layers == 0) {
        take_placed(*open_volume(path), path, space, mask);
        return mask;
    }
    const LayeredMask layered(path, layers, segments);
    take_placed(layered, path, space, mask);
    mask.remarks.push_back(sentence(path.string(), ": its segments lie in ", layers, " layers, which become one mask",
                                    renumbered_in_words(segments)));
    if (const int64_t overlaps = layered.overlaps(); overlaps > 0)
        mask.losses.push_back(sentence(path.string(), ": ", overlaps, overlaps == 1 ? " voxel lies" : " voxels lie",
                                       " in several segments; a mask holds one group for each voxel: that of the "
                                       "last layer is taken there"));
    return mask;
}

bool is_mask_writable(const std::filesystem::path& path)
{
    return !is_in_archive(path) && (is_mask_export(path) || !states_its_size(path));
}

std::filesystem::path saved_mask_path(const std::filesystem::path& mask)
{
    namespace fs = std::filesystem;
    if (mask.empty() || is_in_archive(mask) || is_mask_writable(mask)) return mask;
    const fs::path plain = mask.has_filename() ? mask : mask.parent_path();
    std::error_code ignored;
    fs::path name = plain.filename();
    if (!fs::is_directory(plain, ignored)) {
        if (lower_case(name.extension().string()) == ".gz") name.replace_extension();
        name.replace_extension();
    }
    return plain.parent_path() / (name += ".labels.zarr");
}

std::string save_mask_as(const std::filesystem::path& path, const Mask& mask, const VolumeInfo& volume,
                         const LabelImage& image, Foreign foreign, const Progress& progress)
{
    if (is_in_archive(path))
        fail(path.string(),
             ": lies in an archive, which is only read; expected a path outside it that ends in .mask, .nrrd, .tif or "
             ".zarr");
    if (is_mask_export(path)) return export_mask(path, mask, volume, image, {}, progress, foreign);
    if (states_its_size(path))
        fail(path.string(), ": has a format in which masks are only read; expected .mask, .nrrd, .tif or .zarr");
    save_mask(path, mask, progress);
    return {};
}

}  // namespace shvr
