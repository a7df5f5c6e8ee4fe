#pragma once
// Imports a volume as a project, for `shvr import`. Voxels are cropped, reversed, blurred and downscaled in this order.
// A stopped import keeps its finished chunks, and repeating the same import resumes it. Any thread.

#include "engine/tasks/task_options.h"

namespace shvr {

struct ImportTask {
    static constexpr const char* TITLE = "Import as project";

    std::filesystem::path volume, project;
    std::optional<VoxelBox> crop;
    bool reverse = false;
    glm::dvec3 blur_voxels{0.0};  ///< sigma in voxels along each axis
    int downscale = 1;
    bool labels = false;  ///< whether the voxels are labels
    std::string raw;      ///< layout of bare voxels, in the form of `parse_raw_layout`
    OpenOptions choice;   ///< spacing, unit, channel, frame
    std::optional<OmeZarrVersion> version;
    bool shards = false;  ///< stores many chunks per file; OME-Zarr 0.5 only
    bool overwrite = false;
    bool allows_incomplete = false;  ///< gives voxels that cannot be read the lowest value of their type, or NaN
    int threads = 0;
    int64_t budget_host_mib = 0;  ///< memory that the import may use; 0: three quarters of the machine's memory

    std::string program = "shvr import";    ///< shown to other processes that want the project meanwhile
    OptionNames names = OptionNames::keys;  ///< how messages name options; not an option itself, nor is `program`
};
void fields(Fields& f, ImportTask& task);

struct ImportResult {
    ImportReport report;
    double seconds = 0.0;
    double megabytes_per_second = 0.0;  ///< counts voxels of the project
};

/// Refuses options that contradict each other. Reads no file.
void check(const ImportTask& task);
/// Refuses a project that is, or contains, the imported file, by any path: replacing the project would remove
/// everything in it, including all annotations. Asks the disk.
void refuse_own_source(const ImportTask& task);
/// Keeps a replaced project until the new one is complete. Fails if another process is writing the project.
ImportResult run(const ImportTask& task, ProgressReporter& reporter);

}  // namespace shvr
