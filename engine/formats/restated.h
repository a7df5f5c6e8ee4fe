#pragma once
// Applies the spacing, unit and fill value that the user states, for files that state none or wrong ones. Any thread.

#include <filesystem>
#include <memory>
#include <optional>

#include "engine/volume/source.h"

namespace shvr {

/// Returns `source` with the fill value `nodata` (VolumeInfo::nodata), if that is not null.
std::unique_ptr<VolumeSource> with_nodata(std::unique_ptr<VolumeSource> source, std::optional<double> nodata);

/// Returns `source` with the fill value, the spacing and the unit of `options`, or `source` itself if `options` state
/// none of these. Drops warnings about missing values that `options` supply, and adds a warning with both values if the
/// file states a different value. Converts the origin if the file and `options` both state units of length. Fails if
/// the result would have a spacing without a unit, or a unit without a spacing. Voxels, levels and other facts stay the
/// same.
std::unique_ptr<VolumeSource> restated(std::unique_ptr<VolumeSource> source, const std::filesystem::path& path,
                                       const OpenOptions& options);

}  // namespace shvr
