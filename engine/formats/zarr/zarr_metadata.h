#pragma once
// What an array of Zarr version 2 says of itself, in its file .zarray
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
    // For writing; what is stored says itself how to decode it.
    std::string codec = "zstd";  ///< blosc's
    int level = 1;
    int shuffle = 1;  ///< blosc's: 0 none, 1 bytes, 2 bits
};

struct ZarrMetadata {
    std::vector<int64_t> shape{};   ///< voxels along each axis of the array, slowest first
    std::vector<int64_t> chunks{};  ///< the same of a chunk; those at the end of an axis are as large
    VoxelType type = VoxelType::uint8;
    bool big_endian = false;
    bool is_fortran = false;          ///< inside a chunk, the first axis is the fastest
    std::array<std::byte, 8> fill{};  ///< a voxel of chunks that are not there: its first bytes_of(type) bytes
    char separator = '.';             ///< between the numbers in a chunk's name
    ZarrCompressor compressor{};

    size_t chunk_bytes() const;
};

/// The metadata of the array in a folder. Fails where a field is missing, says what it may not, or what is not
/// supported (filters, other types and compressors); and where a chunk is larger than LARGEST_CHUNK_BYTES.
ZarrMetadata read_zarr_metadata(const std::filesystem::path& array);

/// The content of .zarray; the same for equal metadata.
std::string to_text(const ZarrMetadata& metadata);

}  // namespace shvr
