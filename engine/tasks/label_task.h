#pragma once
// Connected components of a whole volume: what `shvr label` does. Any thread.

#include "engine/components/components.h"
#include "engine/tasks/task_options.h"

namespace shvr {

struct LabelTask {
    static constexpr const char* TITLE = "Label connected parts";

    double threshold = 0.0;  ///< inclusive, in intensity units
    Connectivity connectivity = Connectivity::faces;
    int64_t fewest_voxels = 1;     ///< smaller components are left out
    int64_t largest = 0;           ///< only so many, the largest; 0: all
    std::filesystem::path output;  ///< .zarr, .nrrd, .tif, .mask, or IMAGE/labels/NAME; empty: counts alone
    std::optional<OmeZarrVersion> version;
    bool allows_incomplete = false;  ///< voxels that cannot be read are as low as their type allows
    int threads = 0;

    OptionNames names = OptionNames::keys;  ///< in messages; not an option
};
void fields(Fields& f, LabelTask& task);

struct LabelResult {
    Components::Counts counts;
    double seconds = 0.0;
    double label_seconds = 0.0;     ///< without writing
    std::optional<VoxelType> type;  ///< of labels; nothing where none are written
    int64_t voxels_not_read = 0;
    std::vector<std::string> warnings;  ///< that voxels could not be read
};

/// Options and names.
void check(const LabelTask& task);
/// Also whether the output can be written for such a volume: of a sparse one an OME-Zarr costs what is stored, all
/// other forms hold every voxel. `volume`: its file, or empty, which the output may not replace.
void check(const LabelTask& task, const VolumeSource& source, const std::filesystem::path& volume);
/// `source`: with density offsets, if there are any. `name`: of the volume, for the line of progress.
LabelResult run(const LabelTask& task, const VolumeSource& source, const std::string& name, ProgressReporter& reporter);

}  // namespace shvr
