#pragma once
// Bytes behind deflate, wrapped as gzip or zlib wrap it (told apart by zlib): compressed NRRD, MetaImage and NIfTI.
//
// Deflate can only be read forwards, and any byte may need the 32 KiB before it. While reading forwards, copies of the
// decoder's state are kept every few MiB, so that a box is decoded from the nearest one before it, and what was decoded
// last is kept for a while. A pass from front to back decodes every byte once. Memory: at most 512 states of 40 KiB,
// and the decoded chunks kept (32 MiB, or less where less is asked for). One thread decodes at a time.

#include <string>
#include <string_view>

#include "engine/formats/voxel_bytes.h"

namespace shvr {

struct Inflation {
    InputFile file;
    int64_t offset_bytes = 0;  ///< where in the file the compressed bytes begin
    int64_t skip_bytes = 0;    ///< decoded bytes before those that are wanted
    int64_t wanted_bytes = 0;
    int64_t kept_bytes = int64_t{32} << 20;
};

/// Nothing is decoded yet. Fails where the file begins with neither gzip nor zlib, or is so short that no deflate
/// stream in it can hold what is wanted: at most 1032 bytes come out of one (zlib's technical notes).
std::unique_ptr<VoxelBytes> bytes_of_deflated(Inflation inflation);

/// Whether these are the first bytes of a gzip file.
bool begins_as_gzip(std::string_view head);
/// The first decoded bytes of a gzip file, at most `max_bytes`; fewer where there are no more or they are damaged.
std::string inflated_head(const std::filesystem::path& path, size_t max_bytes);

}  // namespace shvr
