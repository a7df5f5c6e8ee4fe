#pragma once
// Spacing, unit and fill value stated by the user, where a file states none or wrong ones. Any thread may call these.

#include <filesystem>
#include <memory>
#include <optional>

#include "engine/volume/source.h"

namespace shvr {

/// Returns `source` with that fill value (VolumeInfo::nodata), if there is one.
std::unique_ptr<VolumeSource> with_nodata(std::unique_ptr<VolumeSource> source, std::optional<double> nodata);

/// Returns `source` with the fill value, the spacing and the unit of `options`; `source` itself if they state none.
/// Warnings about missing values are dropped if the options supply them; a warning with both values is added if the
/// file states another. An origin is converted if the file and the options state units of length. Fails if that leaves
/// a spacing without a unit, or a unit without a spacing. Voxels, levels and what else is known about them are
/// unchanged.
std::unique_ptr<VolumeSource> restated(std::unique_ptr<VolumeSource> source, const std::filesystem::path& path,
                                       const OpenOptions& options);

}  // namespace shvr
