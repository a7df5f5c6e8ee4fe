#pragma once
// Reads Zarr's JSON files. They are untrusted, so their size and depth are limited. Any thread may call these.

#include "engine/base/json.h"
#include "engine/formats/zarr/store/zarr_store.h"

namespace shvr {

/// Size limits. Metadata files are small, but attributes may also hold data of other programs.
inline constexpr int64_t MAX_ZARR_METADATA_BYTES = int64_t{1} << 20;
inline constexpr int64_t MAX_ZARR_ATTRIBUTE_BYTES = int64_t{4} << 20;

/// Reads the JSON object in a file. Fails if the file is not valid JSON, holds no object, or nests more than 64 deep.
/// Repeated keys are allowed, since some of the programs that write attributes repeat keys.
JsonDocument read_zarr_json(const std::filesystem::path& file, int64_t max_bytes);
/// Likewise, reads the JSON object stored as `name` in a group or an array.
JsonDocument read_zarr_json(const ZarrPlace& place, const std::string& name, int64_t max_bytes);

}  // namespace shvr
