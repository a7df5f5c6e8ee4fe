#pragma once
// Compresses and decompresses chunks of Zarr (blosc, zstd, zlib, gzip, or none), and verifies their checksums (crc32c).
// Stored data is untrusted: the decoded size of a chunk, both stated and actual, must be exactly the size that the
// metadata imply. Any thread may call these.

#include <span>
#include <string>
#include <vector>

#include "engine/formats/zarr/metadata/zarr_metadata.h"

namespace shvr {

/// Returns the maximum size of a compressed chunk with any compressor. Larger files are refused before they are read.
int64_t longest_stored(int64_t chunk_bytes);

/// Fails if `stored_bytes` are too few to decode to `chunk_bytes`. Call this before memory is allocated.
void check_stored_size(std::span<const ZarrCompressor> codecs, size_t stored_bytes, size_t chunk_bytes,
                       const std::string& name);
/// Decodes into `chunk`, which the result must fill exactly. `name` is the chunk's name in messages.
void decode_chunk(std::span<const ZarrCompressor> codecs, std::span<const std::byte> stored, std::span<std::byte> chunk,
                  const std::string& name);
/// Verifies the checksum at the end of `stored`; returns the bytes before it. Fails on a wrong or incomplete checksum.
std::span<const std::byte> without_checksum(std::span<const std::byte> stored, const std::string& name);

/// Decompresses a chunk with the given compressor, which must not be crc32c.
void decompress_chunk(ZarrCompressor::Kind kind, std::span<const std::byte> stored, std::span<std::byte> chunk,
                      const std::string& name);

/// Compresses a chunk; equal input gives equal bytes. Supports only blosc and none, which are the codecs that we write.
/// The result is in `memory`, a buffer that is reused from call to call, or is `chunk` itself.
std::span<const std::byte> compress_chunk(const ZarrCompressor& compressor, std::span<const std::byte> chunk,
                                          size_t voxel_bytes, std::vector<std::byte>& memory);

}  // namespace shvr
