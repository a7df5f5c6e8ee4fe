#pragma once
// Spacing and unit stated by the user, where a file states none or wrong ones. Any thread may call these.

#include <filesystem>
#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// Returns `source` with the spacing and the unit of `options`; `source` itself if they state neither. Warnings about
/// missing values are dropped if the options supply them; a warning with both values is added if the file states
/// another. An origin is converted if the file and the options state units of length. Fails if that leaves a spacing
/// without a unit, or a unit without a spacing. Voxels, levels and what is known about them are unchanged.
std::unique_ptr<VolumeSource> restated(std::unique_ptr<VolumeSource> source, const std::filesystem::path& path,
                                       const OpenOptions& options);

}  // namespace shvr
