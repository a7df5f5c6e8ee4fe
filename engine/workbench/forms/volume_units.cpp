#include "engine/workbench/forms/volume_units.h"

#include "engine/volume/unit.h"

namespace shvr::ui {

std::string unit_of_lengths(const VolumeInfo& volume)
{
    if (volume.unit.empty() || volume.unit == "voxel") return "voxels";
    return unit_in_words(volume.unit);
}

bool has_cubic_millimetres(const VolumeInfo& volume)
{
    return micrometres_in(volume.unit).has_value();
}

}  // namespace shvr::ui
