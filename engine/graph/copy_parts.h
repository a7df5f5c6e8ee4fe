#pragma once
// Splits copies into parts, so that no queue submission takes long: some drivers run one dispatch per slice of each
// region, and memory bandwidth is limited everywhere. Pure functions; any thread.

#include "engine/graph/frame_graph.h"

namespace shvr {

/// Limits of one part. A part exceeds MAX_COPY_BYTES only if it is a single slice of a region.
inline constexpr size_t MAX_COPY_REGIONS = 256;
inline constexpr uint64_t MAX_COPY_BYTES = uint64_t{64} << 20;

/// Returns the regions in order, grouped into parts. Regions that are too long for a part are split.
std::vector<std::vector<BufferRegion>> copy_parts(const std::vector<BufferRegion>& regions);
std::vector<std::vector<ImageRegion>> copy_parts(const std::vector<ImageRegion>& regions, Format format);

}  // namespace shvr
