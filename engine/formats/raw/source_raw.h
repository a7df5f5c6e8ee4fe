#pragma once
// Voxels that lie one after the other: what RAW files hold, and what the headers of NRRD, MetaImage and NIfTI describe,
// in one file or in many, bare or deflated.

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
    /// Nothing: not stated. Little-endian is taken, with a warning; it says so where neighbours are more alike the
    /// other way round.
    std::optional<bool> big_endian = false;
    bool is_deflated = false;   ///< gzip or zlib, from `offset_bytes` of the file on
    int64_t skip_bytes = 0;     ///< where deflated: decoded bytes before the voxels
    int64_t bytes_after = 0;    ///< what the header says follows the voxels: other points in time
    std::vector<Part> parts{};  ///< instead of `file`: equal shares of the voxels, in this order
    int64_t channels = 1;       ///< values of each voxel, one after the other
    int64_t channel = 0;        ///< the one that is taken
};

/// `info.warnings` may grow. Fails where a file is no regular file or too short; nothing large is allocated.
std::unique_ptr<VolumeSource> open_raw_voxels(VolumeInfo info, const RawVoxels& voxels);

}  // namespace shvr
