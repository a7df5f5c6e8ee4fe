#pragma once
// The metadata of an array of Zarr version 2, from its file .zarray
// (https://zarr.readthedocs.io/en/stable/spec/v2.html). Any thread may call these.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/volume/volume.h"

namespace shvr {

/// A chunk is decoded as a whole, so its size is bounded.
inline constexpr int64_t LARGEST_CHUNK_BYTES = int64_t{256} << 20;

struct ZarrCompressor {
    enum class Kind { none, blosc, zstd, zlib, gzip };
    Kind kind = Kind::none;
    // For writing; stored chunks state themselves how to decode them.
    std::string codec = "zstd";  ///< blosc's
    int level = 1;
    int shuffle = 1;  ///< blosc's: 0 none, 1 bytes, 2 bits
};

struct ZarrMetadata {
    std::vector<int64_t> shape{};   ///< voxels along each axis of the array, slowest first
    std::vector<int64_t> chunks{};  ///< the same for a chunk; chunks at the end of an axis have the full size too
    VoxelType type = VoxelType::uint8;
    bool big_endian = false;
    bool is_fortran = false;          ///< inside a chunk, the first axis is the fastest
    std::array<std::byte, 8> fill{};  ///< a voxel of missing chunks: its first bytes_of(type) bytes
    char separator = '.';             ///< between the numbers in a chunk's name
    ZarrCompressor compressor{};

    size_t chunk_bytes() const;
};

/// Reads the metadata of the array in a folder. Fails if a field is missing, invalid or not supported (filters, other
/// types and compressors), or if a chunk is larger than LARGEST_CHUNK_BYTES.
ZarrMetadata read_zarr_metadata(const std::filesystem::path& array);

/// The content of .zarray; equal for equal metadata.
std::string to_text(const ZarrMetadata& metadata);

}  // namespace shvr
