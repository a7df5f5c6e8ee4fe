#pragma once
// Voxels that lie bare in a file, one after the other: what RAW files hold, and what the headers of NRRD and MetaImage
// describe. Read with pread, never mapped: a file cut short while it is open is an `Error`, not a signal.

#include "engine/volume/source.h"

namespace shvr {

struct RawVoxels {
    static constexpr int64_t AT_END = -1;

    std::filesystem::path file{};
    int64_t offset_bytes = 0;  ///< AT_END: the voxels are the last bytes of the file
    bool big_endian = false;
};

/// `info.warnings` may grow. Fails where the file is no regular file or too short; nothing large is allocated.
std::unique_ptr<VolumeSource> open_raw_voxels(VolumeInfo info, const RawVoxels& voxels);

}  // namespace shvr
