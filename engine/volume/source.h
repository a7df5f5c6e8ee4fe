#pragma once
// Where voxels come from. A source knows one volume and hands out boxes of it in the file's own type; it knows nothing
// of bricks, windows or devices. Readers are functions: a null source means "not my format", an `Error` means "mine,
// but broken". `open_volume` (open_volume.h) tries them in a listed order.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "engine/volume/volume.h"

namespace shvr {

class VolumeSource {
public:
    virtual ~VolumeSource() = default;

    const VolumeInfo& info() const { return info_; }

    /// Copies the voxels of `box` (inside the volume) into `voxels`, x fastest, in the native byte order of
    /// `info().type`; `voxels` holds exactly the box. Any thread may call it; throws `Error` on read errors.
    virtual void read(const VoxelBox& box, std::span<std::byte> voxels) const = 0;

protected:
    explicit VolumeSource(VolumeInfo info) : info_(std::move(info)) {}

private:
    VolumeInfo info_;
};

/// One pass over the whole volume (float32: a second one for the histogram, whose range the first one finds) in slabs
/// of bounded size: at most 32 MiB, at least one row. A volume without a finite voxel has minimum = maximum = mean = 0.
VolumeStatistics measure(const VolumeSource& source);

}  // namespace shvr
