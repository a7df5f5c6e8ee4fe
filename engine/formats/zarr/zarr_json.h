#pragma once
// The small JSON files of Zarr. They come from strangers: size and depth are bounded. Any thread.

#include "engine/base/json.h"

namespace shvr {

/// Files of metadata are small; attributes may hold what other programs keep there.
inline constexpr int64_t LARGEST_ZARR_METADATA = int64_t{1} << 20;
inline constexpr int64_t LARGEST_ZARR_ATTRIBUTES = int64_t{4} << 20;

/// The object in a file. Fails where it is no valid JSON, no object, or nested more than 64 deep. A key given twice is
/// no error: the attributes are other programs', too, and some of their writers know no better.
JsonDocument read_zarr_json(const std::filesystem::path& file, int64_t max_bytes);

}  // namespace shvr
