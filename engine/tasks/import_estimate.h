#pragma once
// What an import would make, from the header of the scan alone. Any thread; asks the disk.

#include <memory>
#include <optional>

#include "engine/tasks/import_task.h"

namespace shvr {

/// Opens the volume of an import, with its choices of spacing, channel, level and layout.
std::unique_ptr<VolumeSource> open_for_import(const ImportTask& task);

struct ImportEstimate {
    VolumeInfo scan{};                   ///< the file, with what the task states about it
    Size3 size{0};                       ///< voxels of the project
    double most_bytes = 0.0;             ///< size of the project with all levels, before compression
    std::optional<double> free_bytes{};  ///< where the project is made; null: unknown
    /// A free name beside the project's, if there is something of that name already; empty: there is not.
    std::filesystem::path free_name{};
};
/// Reads the header of the scan, no voxels. Fails as `run` would.
ImportEstimate estimate_of(const ImportTask& task);

}  // namespace shvr
