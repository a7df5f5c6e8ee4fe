#pragma once
// Labels the connected components of a whole volume, for `shvr label`. Any thread.

#include "engine/components/components.h"
#include "engine/tasks/task_options.h"

namespace shvr {

struct LabelTask {
    static constexpr const char* TITLE = "Label connected parts";

    double threshold = 0.0;  ///< inclusive, in intensity units
    Connectivity connectivity = Connectivity::faces;
    int64_t fewest_voxels = 1;     ///< smaller components are left out
    int64_t largest = 0;           ///< keeps only the largest N; 0: all
    std::filesystem::path output;  ///< .zarr, .nrrd, .tif, .mask, or IMAGE/labels/NAME; empty: the task only counts
    std::optional<OmeZarrVersion> version;
    bool allows_incomplete = false;  ///< gives voxels that cannot be read the lowest value of their type
    int threads = 0;

    OptionNames names = OptionNames::keys;  ///< how messages name options; not an option itself
};
void fields(Fields& f, LabelTask& task);

struct LabelResult {
    Components::Counts counts;
    double seconds = 0.0;
    double label_seconds = 0.0;     ///< seconds of labelling, without writing
    std::optional<VoxelType> type;  ///< type of the labels; null if none are written
    int64_t voxels_not_read = 0;
    std::vector<std::string> warnings;  ///< about voxels that could not be read
};

/// Returns the existing file or image that the task would replace. Asks the disk.
std::vector<std::filesystem::path> replaced_files(const LabelTask& task);
/// Checks options and names.
void check(const LabelTask& task);
/// Also checks whether `source` can be written in the format of the output: an OME-Zarr of a sparse volume needs only
/// the stored blocks, whereas all other formats contain every voxel. `volume`: the volume's file, which the output may
/// not replace; may be empty.
void check(const LabelTask& task, const VolumeSource& source, const std::filesystem::path& volume);
/// `source`: the volume, with its density offsets added. `name`: the volume's name, for the progress line.
LabelResult run(const LabelTask& task, const VolumeSource& source, const std::string& name, ProgressReporter& reporter);

}  // namespace shvr
