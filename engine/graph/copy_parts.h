#pragma once
// Splits copies into parts so that no queue submission takes long: some drivers run one dispatch per slice of each
// region, and all drivers are limited by bandwidth. Pure functions; any thread.

#include "engine/graph/frame_graph.h"

namespace shvr {

/// Limits of one part. Only a part that is a single slice of a region may exceed them.
inline constexpr size_t MAX_COPY_REGIONS = 256;
inline constexpr uint64_t MAX_COPY_BYTES = uint64_t{64} << 20;

/// Returns the regions in order, grouped into parts; long regions are split.
std::vector<std::vector<BufferRegion>> copy_parts(const std::vector<BufferRegion>& regions);
std::vector<std::vector<ImageRegion>> copy_parts(const std::vector<ImageRegion>& regions, Format format);

}  // namespace shvr
