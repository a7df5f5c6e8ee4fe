#pragma once
// The small JSON files of Zarr. They are untrusted: their size and depth are bounded. Any thread may call these.

#include "engine/base/json.h"
#include "engine/formats/zarr/store/zarr_store.h"

namespace shvr {

/// Size limits. Metadata files are small; attributes may also hold data of other programs.
inline constexpr int64_t MAX_ZARR_METADATA_BYTES = int64_t{1} << 20;
inline constexpr int64_t MAX_ZARR_ATTRIBUTE_BYTES = int64_t{4} << 20;

/// Reads the object in a file. Fails if it is not valid JSON, not an object, or nested more than 64 deep. Repeated keys
/// are allowed, since other programs also write attributes, and some of them repeat keys.
JsonDocument read_zarr_json(const std::filesystem::path& file, int64_t max_bytes);
/// Likewise, reads the object in the value `name` of a group or an array.
JsonDocument read_zarr_json(const ZarrPlace& place, const std::string& name, int64_t max_bytes);

}  // namespace shvr
