#pragma once
// A mask in forms that other programs read. Any thread may call this.
//
//   .mask   the thesis's raw bytes (mask_file.h)
//   .nrrd   raw bytes behind a header with spacing and unit
//   .tif    a page a slice, compressed; spacing and unit as ImageJ has them; BigTIFF where it must be

#include <filesystem>

#include "engine/annotation/trace_file.h"

namespace shvr {

bool is_mask_export(const std::filesystem::path& path);

/// Replaces an old file at once or not at all. `space.size` is the mask's. A compressed TIFF is held in memory until it is
/// whole.
void export_mask(const std::filesystem::path& path, const Mask& mask, const TraceSpace& space);

}  // namespace shvr
