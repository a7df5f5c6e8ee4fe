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
    std::optional<StoredChunks> stored{};  ///< the chunks that alone are gone through; null: all voxels are
};

/// Stored chunks alone if the source knows them, they are at most an eighth of all, and their preparation is at most
/// --crop. Fails if the import would take more memory than its budget, or makes tables that are too large.
ImportPlan plan_import(const VolumeSource& source, const std::filesystem::path& project, const ImportOptions& options);

/// Fails if the ranges or checksums of all bricks or chunks, which going through all voxels gathers, are too large.
void check_all_tables(const std::filesystem::path& project, const VolumeInfo& info);

int import_threads(int wanted);

}  // namespace shvr
