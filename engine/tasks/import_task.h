#pragma once
// Makes a project of a volume: what `shvr import` does. The order is: crop, reverse, blur, downscale. An import that
// was stopped keeps what is done, and the same import continues it. Any thread.

#include "engine/tasks/task_options.h"

namespace shvr {

struct ImportTask {
    static constexpr const char* TITLE = "Import as project";

    std::filesystem::path volume, project;
    std::optional<VoxelBox> crop;
    bool reverse = false;
    glm::dvec3 blur_voxels{0.0};  ///< sigma
    int downscale = 1;
    bool labels = false;  ///< the voxels are labels
    std::string raw;      ///< for bare voxels, as `parse_raw_layout` takes it
    OpenOptions choice;   ///< spacing, unit, channel, frame
    std::optional<OmeZarrVersion> version;
    bool shards = false;  ///< of version 0.5: many chunks in a file
    bool overwrite = false;
    int threads = 0;

    std::string program = "shvr import";    ///< told to others who want the project that is being replaced
    OptionNames names = OptionNames::keys;  ///< in messages; these two are not options
};
void fields(Fields& f, ImportTask& task);

struct ImportResult {
    ImportReport report;
    double seconds = 0.0;
    double megabytes_per_second = 0.0;  ///< of the project's voxels
};

/// Refuses options that contradict each other; reads nothing.
void check(const ImportTask& task);
/// A project that is replaced stays until the new one is complete, and nobody may be writing it.
ImportResult run(const ImportTask& task, ProgressReporter& reporter);

}  // namespace shvr
