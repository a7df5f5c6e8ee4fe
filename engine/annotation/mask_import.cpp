#include "engine/annotation/mask_import.h"

#include <algorithm>
#include <cmath>

#include "engine/annotation/mask_file.h"
#include "engine/annotation/mask_source.h"
#include "engine/annotation/measures.h"
#include "engine/base/error.h"
#include "engine/volume/header_text.h"
#include "engine/volume/open_volume.h"

namespace shvr {

namespace {

/// TIFFs hold spacings as fractions of 32 bits.
constexpr double SPACING_TOLERANCE = 1e-5;

void check_place(const std::filesystem::path& path, const VolumeInfo& mask, const TraceSpace& space)
{
    if (mask.size != space.size)
        fail(path.string(), ": is a mask of ", digits_of(mask.size), " voxels; expected ", digits_of(space.size),
             ", the size of this volume");
    const std::string unit = plain_unit(mask.unit);
    // What is not stated cannot be wrong.
    if (unit == "voxel" || space.unit == "voxel") return;
    const std::optional<double> from = micrometres_in(unit), to = micrometres_in(space.unit);
    const double factor = from && to ? *from / *to : 1.0;
    const glm::dvec3 away = glm::abs(factor * mask.spacing - space.spacing);
    const bool is_equal = glm::all(glm::lessThanEqual(away, SPACING_TOLERANCE * space.spacing));
    if (!is_equal || (unit != space.unit && !(from && to)))
        fail(path.string(), ": is a mask with voxels of ", digits_of(mask.spacing), " ", unit, "; expected ",
             digits_of(space.spacing), " ", space.unit, ", the spacing of this volume");
}

bool is_folder(const std::filesystem::path& path)
{
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored);
}

}  // namespace

bool is_mask_volume(const std::filesystem::path& path)
{
    std::string name = lower_case(path.filename().string());
    if (name.ends_with(".gz")) name.resize(name.size() - 3);
    constexpr const char* FORMS[] = {".nrrd", ".nhdr", ".mhd", ".mha", ".nii", ".tif", ".tiff"};
    return is_folder(path) || std::ranges::any_of(FORMS, [&](const char* form) { return name.ends_with(form); });
}

std::vector<MaskBrickChange> import_mask(const std::filesystem::path& path, const TraceSpace& space)
{
    if (!is_mask_volume(path)) return load_mask(path, space.size);
    const std::unique_ptr<VolumeSource> source = open_volume(path);
    check_place(path, source->info(), space);
    return mask_changes(*source, path.string());
}

void save_mask_as(const std::filesystem::path& path, const Mask& mask, const VolumeInfo& volume,
                  const LabelImage& image)
{
    if (is_mask_export(path)) return export_mask(path, mask, volume, image);
    if (is_mask_volume(path))
        fail(path.string(), ": is a form in which masks are only read; expected .mask, .nrrd, .tif or .zarr");
    save_mask(path, mask);
}

}  // namespace shvr
