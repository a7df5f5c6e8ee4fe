#pragma once
// Reads the part of a source that is imported, optionally reversed. For import_prepare.cpp and import_filter.cpp. One
// thread at a time, the one that owns the pool.

#include <span>

#include "engine/base/work_pool.h"
#include "engine/projects/import_prepare.h"
#include "engine/volume/source.h"

namespace shvr {

/// Maximum bytes of decoded blocks that sources keep.
inline constexpr double SOURCE_CACHE_BYTES = double(64 << 20);

/// Number of voxels as double, which does not overflow for any size.
inline double voxels_in(const Size3& extent)
{
    return double(extent.x) * double(extent.y) * double(extent.z);
}

class ImportBox {
public:
    /// `source` must outlive this object. If voxels are to be reversed, the constructor first reads all of them to find
    /// their range, and reports its progress to `progress`.
    ImportBox(const VolumeSource& source, const VoxelBox& box, bool reverses, const Progress& progress = {});

    VoxelType type() const { return source_.info().type; }
    Size3 size() const { return box_.size(); }
    /// The block size of the source.
    Size3 block() const { return source_.block(); }

    /// Reads the voxels of `part`, counted from the box's first voxel, x fastest, with all workers.
    void read(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const;
    /// An upper bound of the memory, in bytes, for reading a part of this size: the source's decoded blocks, and the
    /// workers' copies of blocks.
    double bytes(const Size3& extent, int workers) const;

private:
    void read_slices(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const;
    void read_blocks(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const;
    void reverse(std::span<std::byte> voxels) const;

    const VolumeSource& source_;
    VoxelBox box_;
    bool reverses_;
    double ends_ = 0.0;  ///< smallest plus largest value of the source, for reversing
};

/// Like make_preparation in import_prepare.h; `progress` reports the pass that finds the range for reversing.
std::unique_ptr<Preparation> make_preparation(const VolumeSource& source, const PreparationOptions& options,
                                              const Progress& progress);

}  // namespace shvr
