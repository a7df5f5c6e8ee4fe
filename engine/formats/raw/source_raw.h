#pragma once
// Opens voxels stored one after the other, in one file or many, raw or deflated: RAW files, and the data that headers
// of NRRD, MetaImage and NIfTI describe.

#include "engine/volume/source.h"

namespace shvr {

struct RawVoxels {
    static constexpr int64_t AT_END = -1;

    struct Part {
        std::filesystem::path file{};
        int64_t offset_bytes = 0;
    };

    std::filesystem::path file{};
    int64_t offset_bytes = 0;  ///< AT_END: the voxels are the last bytes of the file
    /// Null if the file does not state its byte order. Little-endian is then assumed, with a warning that suggests
    /// big-endian if neighbouring voxels are more similar in that order.
    std::optional<bool> big_endian = false;
    bool is_deflated = false;   ///< compressed with gzip or zlib, starting at `offset_bytes`
    int64_t skip_bytes = 0;     ///< if deflated: number of decoded bytes before the voxels
    int64_t bytes_after = 0;    ///< bytes after the voxels, which hold other time points
    std::vector<Part> parts{};  ///< used instead of `file`: parts with equal shares of the voxels, in order
    int64_t channels = 1;       ///< number of values per voxel, stored one after the other
    int64_t channel = 0;        ///< index of the value to read
};

/// May add to `info.warnings`. Fails if a file is not a regular file or is too short; allocates nothing large.
std::unique_ptr<VolumeSource> open_raw_voxels(VolumeInfo info, const RawVoxels& voxels);

}  // namespace shvr
