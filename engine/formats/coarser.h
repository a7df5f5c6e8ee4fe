#pragma once
// A coarser level of a volume as a volume of its own. Any thread may call this.

#include <filesystem>
#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// Returns a volume whose finest level is level `level` of `source`, with voxels 2^level times as wide; returns
/// `source` itself for level 0. Fails if `source` lacks that level. A warning states the level.
std::unique_ptr<VolumeSource> coarser(std::unique_ptr<VolumeSource> source, const std::filesystem::path& path,
                                      int level);

}  // namespace shvr
