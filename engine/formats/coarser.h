#pragma once
// Opens a coarser level of a volume as a volume of its own. Any thread may call this.

#include <filesystem>
#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// Returns a volume whose finest level is level `level` of `source`, so its voxels are 2^level times as wide. Returns
/// `source` itself for level 0. Adds a warning that states the level. Fails if `source` lacks the level.
std::unique_ptr<VolumeSource> coarser(std::unique_ptr<VolumeSource> source, const std::filesystem::path& path,
                                      int level);

}  // namespace shvr
