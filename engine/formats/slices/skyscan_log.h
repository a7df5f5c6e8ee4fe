#pragma once
// Reads the log that SkyScan scanners and NRecon write next to slices ("bone_rec.log" for "bone_rec0000.tif"): lines
// like "Pixel Size (um)=17.5" in sections like "[Reconstruction]". Only the spacing is used. Any thread may call these.

#include <filesystem>

#include "engine/volume/volume.h"

namespace shvr {

/// Sets the spacing of `info`, whose size is known, from the log that belongs to the slice. Warns if the log's spacing
/// differs from that of the slices. Does nothing if there is no such log. A log that is malformed, or does not fit the
/// slices, is ignored with a warning.
void apply_skyscan_log(const std::filesystem::path& slice, VolumeInfo& info);

}  // namespace shvr
