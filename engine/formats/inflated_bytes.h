#pragma once
// Bytes compressed with deflate, wrapped as gzip or zlib (zlib detects which): compressed NRRD, MetaImage and NIfTI.
//
// Deflate can only be read forwards, and any byte may depend on the preceding 32 KiB. While reading forwards, copies of
// the decoder's state are saved every few MiB, so that a box is decoded from the nearest state before it, and recently
// decoded chunks are cached. A pass from front to back decodes every byte once. Memory: at most 512 states of 40 KiB,
// and the cached chunks (`kept_bytes`, by default 32 MiB). One thread decodes at a time.

#include <string>
#include <string_view>

#include "engine/formats/voxel_bytes.h"

namespace shvr {

struct Inflation {
    InputFile file;
    int64_t offset_bytes = 0;  ///< file offset at which the compressed bytes begin
    int64_t skip_bytes = 0;    ///< decoded bytes before the requested ones
    int64_t wanted_bytes = 0;
    int64_t kept_bytes = int64_t{32} << 20;
};

/// Returns a source of decoded bytes, which decodes on demand. Fails if the data has neither a gzip nor a zlib header,
/// or is too short for the requested bytes: deflate expands a byte to at most 1032 bytes (zlib's technical notes).
std::unique_ptr<VoxelBytes> bytes_of_deflated(Inflation inflation);

/// Whether `head` begins like a gzip file.
bool begins_as_gzip(std::string_view head);
/// Returns the first decoded bytes of a gzip file, at most `max_bytes`; fewer if the file ends earlier or is damaged.
std::string inflated_head(const std::filesystem::path& path, size_t max_bytes);

}  // namespace shvr
