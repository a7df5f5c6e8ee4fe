#pragma once
// Decides how a volume is imported, before memory is allocated or voxels are read. For import_volume.cpp.

#include <filesystem>
#include <optional>

#include "engine/projects/import_volume.h"
#include "engine/projects/levels/import_pyramid.h"
#include "engine/volume/stored_chunks.h"

namespace shvr {

struct ImportPlan {
    FillVoxel fill{};                      ///< value of voxels in chunks that are not stored
    std::optional<StoredChunks> stored{};  ///< the chunks to visit; null: all voxels are visited
};

/// Selects only the stored chunks if the source can list them, they are at most an eighth of all chunks, and cropping
/// is the only preparation. Fails if the import would exceed its memory budget or make tables that are too large.
ImportPlan plan_import(const VolumeSource& source, const std::filesystem::path& project, const ImportOptions& options);

/// Fails if a dense pass would make tables of brick ranges or chunk checksums that are too large.
void check_all_tables(const std::filesystem::path& project, const VolumeInfo& info);

int import_threads(int wanted);

}  // namespace shvr
