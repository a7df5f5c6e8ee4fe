#pragma once
// What an import would make, from the header of the scan alone. Any thread; asks the disk.

#include <memory>
#include <optional>
#include <string>

#include "engine/tasks/import_task.h"

namespace shvr {

/// Opens the volume of an import, with its choices of spacing, channel, level and layout.
std::unique_ptr<VolumeSource> open_for_import(const ImportTask& task);

struct ImportEstimate {
    VolumeInfo scan{};                   ///< the file, with what the task states about it
    Size3 size{0};                       ///< voxels of the project
    double most_bytes = 0.0;             ///< size of the project with all levels, before compression
    std::optional<double> free_bytes{};  ///< where the project is made; null: unknown
};
/// Reads the header of the scan, no voxels. Fails as `run` would.
ImportEstimate estimate_of(const ImportTask& task);

/// What is where the project of an import is to be made.
struct ImportPlace {
    std::string why_not{};              ///< why no project can be made there, in a sentence for a dialog; empty: it can
    bool is_project = false;            ///< a project is there, which `overwrite` replaces
    std::string annotation{};           ///< what that project holds of it: "paint (labels/paint)"; empty: none
    std::filesystem::path free_name{};  ///< a free name next to that of the project, if it is taken
};
/// Looks at names in folders only: at neither the scan nor voxels.
ImportPlace look_at_place(const ImportTask& task);

}  // namespace shvr
