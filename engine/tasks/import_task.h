#pragma once
// Imports a volume as a project, for `shvr import`. The order is: crop, reverse, blur, downscale. A stopped import
// keeps its finished chunks, and the same import resumes it. Any thread.

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
    std::string raw;      ///< layout of bare voxels, in the form of `parse_raw_layout`
    OpenOptions choice;   ///< spacing, unit, channel, frame
    std::optional<OmeZarrVersion> version;
    bool shards = false;  ///< version 0.5 only: many chunks per file
    bool overwrite = false;
    int threads = 0;
    int64_t budget_host_mib = 0;  ///< memory that it may take; 0: three quarters of the machine's

    std::string program = "shvr import";    ///< shown to other processes that want the project being replaced
    OptionNames names = OptionNames::keys;  ///< in messages; these two are not options
};
void fields(Fields& f, ImportTask& task);

struct ImportResult {
    ImportReport report;
    double seconds = 0.0;
    double megabytes_per_second = 0.0;  ///< in the project's voxels
};

/// Refuses options that contradict each other; reads nothing.
void check(const ImportTask& task);
/// A project that is being replaced stays until the new one is complete; fails if another process is writing it.
ImportResult run(const ImportTask& task, ProgressReporter& reporter);

}  // namespace shvr
