#pragma once
// The thesis's `.mask` file: one unsigned byte per voxel, x fastest, no header.

#include <filesystem>

#include "engine/annotation/mask.h"
#include "engine/base/progress.h"

namespace shvr {

/// Writes row by row to a temporary file next to `path`, then syncs and renames it, so a failed save leaves the old
/// file untouched. An exception from `progress` cancels the save.
void save_mask(const std::filesystem::path& path, const Mask& mask, const Progress& progress = {});

/// Fails, naming both sizes, unless the file holds exactly one byte per voxel of `size`. Returns change records, so
/// that loading can be undone like any command.
std::vector<MaskBrickChange> load_mask(const std::filesystem::path& path, const Size3& size);

}  // namespace shvr
