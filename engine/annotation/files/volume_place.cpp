#include "engine/annotation/files/volume_place.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/open_volume.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

/// TIFFs round spacings: they store them as fractions of two 32-bit numbers.
constexpr double SPACING_TOLERANCE = 1e-5;

}  // namespace

bool states_its_size(const std::filesystem::path& path)
{
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored) || is_in_archive(path) ||
           name_states_size(path.filename().string());
}

bool is_in_archive(const std::filesystem::path& path)
{
    return leads_into_archive(path);
}

void check_place(const std::filesystem::path& path, const char* what, const VolumeInfo& found, const TraceSpace& space)
{
    if (found.size != space.size)
        fail(path.string(), ": is ", what, " of ", digits_of(found.size), " voxels; expected ", digits_of(space.size),
             ", the size of this volume");
    const std::string elsewhere = why_elsewhere(space_of(found), space);
    if (!elsewhere.empty())
        fail(path.string(), ": is ", what, " of a volume with ", elsewhere, ", where this volume lies");
    const std::string unit = plain_unit(found.unit);
    // An unstated unit cannot disagree.
    if (unit == "voxel" || space.unit == "voxel") return;
    const std::optional<double> from = micrometres_in(unit), to = micrometres_in(space.unit);
    const double factor = from && to ? *from / *to : 1.0;
    const glm::dvec3 away = glm::abs(factor * found.spacing - space.spacing);
    const bool is_equal = glm::all(glm::lessThanEqual(away, SPACING_TOLERANCE * space.spacing));
    if (!is_equal || (unit != space.unit && !(from && to)))
        fail(path.string(), ": is ", what, " with voxels of ", spacing_in_words(found.spacing, unit), "; expected ",
             spacing_in_words(space.spacing, space.unit), ", the spacing of this volume");
}

VolumeInfo info_beside(const VolumeInfo& volume, const char* name, VoxelType type)
{
    VolumeInfo info = volume;
    info.name = info.format = name;
    info.type = type;
    info.warnings.clear();
    return info;
}

}  // namespace shvr
