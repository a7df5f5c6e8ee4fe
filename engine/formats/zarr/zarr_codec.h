#pragma once
// Chunks of Zarr version 2 in and out of their compressors: blosc, zstd, zlib, gzip, or none. What is stored comes from
// strangers: it must say, or turn out, to be exactly as large as the metadata promise. Any thread may call these.

#include <span>
#include <string>
#include <vector>

#include "engine/formats/zarr/zarr_metadata.h"

namespace shvr {

/// No compressor makes more of a chunk: what is longer is refused before it is read.
int64_t longest_stored(int64_t chunk_bytes);

/// Fails where no chunk of `chunk_bytes` can come out of so few bytes: before memory is taken for it.
void check_stored_size(ZarrCompressor::Kind kind, size_t stored_bytes, size_t chunk_bytes, const std::string& name);
/// Fills `chunk` exactly, or fails with `name`, which is the chunk's.
void decompress_chunk(ZarrCompressor::Kind kind, std::span<const std::byte> stored, std::span<std::byte> chunk,
                      const std::string& name);

/// The same bytes for the same input. Blosc and none only: that is what we write. They lie in `memory`, which is made
/// large enough once and used again, or are `chunk` itself.
std::span<const std::byte> compress_chunk(const ZarrCompressor& compressor, std::span<const std::byte> chunk,
                                          size_t voxel_bytes, std::vector<std::byte>& memory);

}  // namespace shvr
