#pragma once
// Reads metadata fields that both versions of Zarr have. For zarr_metadata.cpp and zarr_v3.cpp. Any thread.

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/base/json.h"
#include "engine/formats/zarr/metadata/zarr_metadata.h"

namespace shvr {

/// Reads the shape of an array or a chunk: 1 to 16 whole numbers above 0.
std::vector<int64_t> read_zarr_sides(const JsonNode& node);
/// Reads a shape like `read_zarr_sides`, but with exactly one number for each axis of the array.
std::vector<int64_t> read_zarr_chunk(const JsonNode& node, size_t axes);

/// Sets `fill` from "fill_value"; the voxel type must be set before. In version 3, floats may be stated by their bits,
/// as in "0x7fc00000".
void read_zarr_fill(const JsonNode& node, ZarrMetadata& metadata);
nlohmann::json zarr_fill(const ZarrMetadata& metadata);

/// Fails if a chunk with the shape in `node` has more than MAX_CHUNK_BYTES.
void check_zarr_chunk(const JsonNode& node, const ZarrMetadata& metadata);

}  // namespace shvr
