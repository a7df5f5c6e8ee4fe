#pragma once
// Decides how a volume is imported, before memory is taken or voxels are read. For import_volume.cpp.

#include <filesystem>
#include <optional>

#include "engine/projects/import_volume.h"
#include "engine/projects/levels/import_pyramid.h"
#include "engine/volume/stored_chunks.h"

namespace shvr {

struct ImportPlan {
    FillVoxel fill{};                      ///< value of voxels in chunks that are not stored
    std::optional<StoredChunks> stored{};  ///< the only chunks to visit; null: all voxels are visited
};

/// Selects only the stored chunks if the source can list them, they are at most an eighth of all, and --crop is the
/// only preparation. Fails if the import would take more memory than its budget, or make tables that are too large.
ImportPlan plan_import(const VolumeSource& source, const std::filesystem::path& project, const ImportOptions& options);

/// Fails if a pass over all voxels would make tables of brick ranges or chunk checksums that are too large.
void check_all_tables(const std::filesystem::path& project, const VolumeInfo& info);

int import_threads(int wanted);

}  // namespace shvr
