#pragma once
// Spacing and unit as the user states them, given where a file states none, or corrected. Any thread may call these.

#include <filesystem>
#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// `source` with the spacing and the unit of `options`; `source` itself if they state neither. Warnings about what the
/// file lacks are dropped where the options supply it; one that names both is added where the file says otherwise. An
/// origin is converted if the file and the options state units of length. Fails if that leaves a spacing without a
/// unit, or a unit without a spacing. Voxels, levels and what is known about them stay.
std::unique_ptr<VolumeSource> restated(std::unique_ptr<VolumeSource> source, const std::filesystem::path& path,
                                       const OpenOptions& options);

}  // namespace shvr
