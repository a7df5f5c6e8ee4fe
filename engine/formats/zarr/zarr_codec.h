#pragma once
// Compresses and decompresses chunks of Zarr: blosc, zstd, zlib, gzip, or none; and checks their checksums, crc32c.
// Stored data is untrusted: its size, stated or found, must be exactly what the metadata promise. Any thread may call
// these.

#include <span>
#include <string>
#include <vector>

#include "engine/formats/zarr/metadata/zarr_metadata.h"

namespace shvr {

/// The maximum size of any compressor's output for a chunk: longer files are refused before they are read.
int64_t longest_stored(int64_t chunk_bytes);

/// Fails if that few bytes cannot decode to `chunk_bytes`; called before memory is allocated.
void check_stored_size(std::span<const ZarrCompressor> codecs, size_t stored_bytes, size_t chunk_bytes,
                       const std::string& name);
/// Fills `chunk` exactly, or fails with `name`, the chunk's name, in the message.
void decode_chunk(std::span<const ZarrCompressor> codecs, std::span<const std::byte> stored, std::span<std::byte> chunk,
                  const std::string& name);
/// Verifies and removes the checksum at the end of `stored`; fails if there are too few bytes, or it does not match.
std::span<const std::byte> without_checksum(std::span<const std::byte> stored, const std::string& name);

/// Applies one of these compressors; not crc32c.
void decompress_chunk(ZarrCompressor::Kind kind, std::span<const std::byte> stored, std::span<std::byte> chunk,
                      const std::string& name);

/// Equal input gives equal bytes. Supports only blosc and none, which we write. The result lies in `memory`, which is
/// allocated once and reused, or is `chunk` itself.
std::span<const std::byte> compress_chunk(const ZarrCompressor& compressor, std::span<const std::byte> chunk,
                                          size_t voxel_bytes, std::vector<std::byte>& memory);

}  // namespace shvr
