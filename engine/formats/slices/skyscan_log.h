#pragma once
// The log that SkyScan scanners and NRecon write next to slices ("bone_rec.log" for "bone_rec0000.tif"): lines
// "Pixel Size (um)=17.5" in sections "[Reconstruction]". Only the spacing is taken from it. Any thread may call these.

#include <filesystem>

#include "engine/volume/volume.h"

namespace shvr {

/// Sets the spacing of `info`, whose size is known, from the log that belongs to the slice, with a warning if the log's
/// spacing differs from that of the slices. Does nothing if there is no such log. A log that does not fit the slices,
/// or that is malformed, is ignored with a warning.
void apply_skyscan_log(const std::filesystem::path& slice, VolumeInfo& info);

}  // namespace shvr
