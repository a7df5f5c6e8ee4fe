#pragma once
// Reads the imported part of a source, and reverses its intensities if required. For import_prepare.cpp and
// import_filter.cpp. Only the thread that owns the pool may call it.

#include <span>

#include "engine/base/waits/work_pool.h"
#include "engine/projects/import_prepare.h"
#include "engine/volume/source.h"

namespace shvr {

/// Upper limit, in bytes, of the decoded blocks that sources cache.
inline constexpr double SOURCE_CACHE_BYTES = double(64 << 20);

/// Number of voxels as a double, which cannot overflow.
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
    /// Returns an upper bound, in bytes, of the memory to read a part of this size: the source's cache of decoded
    /// blocks, and the workers' copies of blocks.
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

/// Like make_preparation() in import_prepare.h. `progress` receives the progress of finding the range for a reversal.
std::unique_ptr<Preparation> make_preparation(const VolumeSource& source, const PreparationOptions& options,
                                              const Progress& progress);

}  // namespace shvr
