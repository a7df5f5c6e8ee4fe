#pragma once
// The metadata of a Zarr array, in one form for version 2 (.zarray, https://zarr.readthedocs.io/en/stable/spec/v2.html)
// and version 3 (zarr.json, https://zarr-specs.readthedocs.io/en/latest/v3/core/). Any thread may call these.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/formats/stored_numbers.h"
#include "engine/formats/zarr/store/zarr_store.h"
#include "engine/volume/volume.h"

namespace shvr {

/// A chunk is decoded as a whole, so its size is bounded.
inline constexpr int64_t MAX_CHUNK_BYTES = int64_t{256} << 20;

/// One step from the bytes of a chunk to the stored bytes: a compressor or a checksum.
struct ZarrCompressor {
    enum class Kind { none, blosc, zstd, zlib, gzip, crc32c };
    Kind kind = Kind::none;
    // Compressor settings for writing; stored chunks state themselves how to decode them.
    std::string codec = "zstd";  ///< blosc's
    int level = 1;
    int shuffle = 1;  ///< blosc's: 0 none, 1 bytes, 2 bits
};

/// Version 3: chunks stored together in a shard, under one key, with an index of their positions
/// (https://zarr-specs.readthedocs.io/en/latest/v3/codecs/sharding-indexed/).
struct ZarrSharding {
    std::vector<int64_t> shape{};  ///< voxels of a shard along each axis, a multiple of those of a chunk
    std::vector<size_t> order{};   ///< order of the axes of the index, the slowest first
    bool is_index_first = false;   ///< whether the index is at the start of a shard, not at its end
    bool is_big_endian = false;    ///< the index
    int checksums = 0;             ///< number of CRC-32C checksums after the index, each over all bytes before it

    int64_t chunks(const std::vector<int64_t>& chunk) const;  ///< chunks per shard
    int64_t index_bytes(const std::vector<int64_t>& chunk) const { return 16 * chunks(chunk) + 4 * checksums; }
};

struct ZarrMetadata {
    int version = 2;                ///< version of Zarr
    std::vector<int64_t> shape{};   ///< voxels along each axis of the array, slowest first
    std::vector<int64_t> chunks{};  ///< the same for a chunk; chunks at the end of an axis have the full size too
    VoxelType type = VoxelType::uint8;
    StoredNumber stored = StoredNumber::plain;  ///< if no voxel type holds its values, `type` is bits_type(stored)
    bool big_endian = false;
    /// The array's axes as stored inside a chunk, slowest first; empty: in the array's order.
    std::vector<size_t> order{};
    std::array<std::byte, 8> fill{};  ///< value of the voxels of missing chunks: the first bytes_of(type) bytes
    bool has_prefix = false;          ///< chunks' names begin with "c"
    char separator = '.';             ///< between the numbers in a chunk's name
    /// In encoding order: at most one compressor, and checksums before and after it.
    std::vector<ZarrCompressor> codecs{};
    std::optional<ZarrSharding> sharding{};
    std::vector<std::string> axes{};  ///< names of the axes, if the file states any

    size_t chunk_bytes() const;
    /// Bytes from one voxel of a chunk to the next along each axis.
    std::vector<size_t> strides() const;
    /// The name of the chunk or shard with this index along each axis, within the array.
    std::string key_of(std::span<const int64_t> numbers) const;
    /// The name of the metadata themselves, within the array.
    const char* key() const { return version == 2 ? ".zarray" : "zarr.json"; }
};

/// Reads the metadata of an array. Fails if a field is missing, invalid or not supported (filters, other types, codecs
/// and grids), or if a chunk is larger than MAX_CHUNK_BYTES.
ZarrMetadata read_zarr_metadata(const ZarrPlace& array, int version);

/// The content of `key()`; equal for equal metadata. The index of a shard must be little-endian, in the array's order,
/// with one checksum.
std::string to_text(const ZarrMetadata& metadata);

}  // namespace shvr
