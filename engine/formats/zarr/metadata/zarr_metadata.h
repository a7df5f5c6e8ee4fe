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

/// Maximum size of a chunk, since a chunk is always decoded as a whole.
inline constexpr int64_t MAX_CHUNK_BYTES = int64_t{256} << 20;

/// One codec of the chain that encodes a chunk: a compressor or a checksum.
struct ZarrCompressor {
    enum class Kind { none, blosc, zstd, zlib, gzip, crc32c };
    Kind kind = Kind::none;
    // Compressor settings, used for writing only: stored chunks themselves state how to decode them.
    std::string codec = "zstd";  ///< blosc's
    int level = 1;
    int shuffle = 1;  ///< shuffle of blosc: 0 none, 1 bytes, 2 bits
};

/// For version 3: the layout of shards, which hold several chunks under one key, with an index of their positions
/// (https://zarr-specs.readthedocs.io/en/latest/v3/codecs/sharding-indexed/).
struct ZarrSharding {
    std::vector<int64_t> shape{};  ///< voxels of a shard along each axis, a multiple of those of a chunk
    std::vector<size_t> order{};   ///< order of the axes in the index, slowest first
    bool is_index_first = false;   ///< true: the index is at the start of a shard; false: at its end
    bool is_big_endian = false;    ///< byte order of the index
    int checksums = 0;             ///< number of CRC-32C checksums after the index, each over all bytes before it

    int64_t chunks(const std::vector<int64_t>& chunk) const;  ///< chunks per shard
    int64_t index_bytes(const std::vector<int64_t>& chunk) const { return 16 * chunks(chunk) + 4 * checksums; }
};

struct ZarrMetadata {
    int version = 2;                ///< version of Zarr
    std::vector<int64_t> shape{};   ///< voxels along each axis of the array, slowest first
    std::vector<int64_t> chunks{};  ///< voxels of a chunk along each axis; chunks at an array's end are no smaller
    VoxelType type = VoxelType::uint8;
    StoredNumber stored = StoredNumber::plain;  ///< unless plain, `type` is only used to read the bits (bits_type)
    bool big_endian = false;
    /// The array's axes in the order in which chunks store them, slowest first; empty: the array's own order.
    std::vector<size_t> order{};
    std::array<std::byte, 8> fill{};  ///< value of voxels in missing chunks, in the first bytes_of(type) bytes
    bool has_prefix = false;          ///< names of chunks begin with "c"
    char separator = '.';             ///< separates the numbers in a chunk's name
    /// The codecs in the order of encoding: at most one compressor, with checksums before and after it.
    std::vector<ZarrCompressor> codecs{};
    std::optional<ZarrSharding> sharding{};
    std::vector<std::string> axes{};  ///< names of the axes, if the file states any

    size_t chunk_bytes() const;
    /// Returns, for each axis, the distance in bytes between neighbouring voxels of a chunk.
    std::vector<size_t> strides() const;
    /// Returns the key, within the array, of the chunk or shard with the given index along each axis.
    std::string key_of(std::span<const int64_t> numbers) const;
    /// Returns the key, within the array, of the metadata.
    const char* key() const { return version == 2 ? ".zarray" : "zarr.json"; }
};

/// Reads the metadata of an array. Fails if a field is missing, invalid or not supported (filters, and some types,
/// codecs and grids are not), or if a chunk is larger than MAX_CHUNK_BYTES.
ZarrMetadata read_zarr_metadata(const ZarrPlace& array, int version);

/// Returns the text to write under `key()`; equal metadata give equal texts. In shards, the index must be
/// little-endian, in the order of the array's axes, and have one checksum.
std::string to_text(const ZarrMetadata& metadata);

}  // namespace shvr
