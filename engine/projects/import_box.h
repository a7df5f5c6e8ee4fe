#pragma once
// The part of a source that is imported, reversed where that is wanted. For import_prepare.cpp and import_filter.cpp.
// One thread at a time, the one that owns the pool.

#include <span>

#include "engine/base/work_pool.h"
#include "engine/volume/source.h"

namespace shvr {

class ImportBox {
public:
    /// `source` must outlive it. Floats that are to be reversed are measured first.
    ImportBox(const VolumeSource& source, const VoxelBox& box, bool reverses);

    VoxelType type() const { return source_.info().type; }
    Size3 size() const { return box_.size(); }
    /// Of the source.
    Size3 block() const { return source_.block(); }

    /// Voxels of `part`, which is counted from the box's first voxel, x fastest; read by all workers.
    void read(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const;

private:
    void read_slices(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const;
    void read_blocks(const VoxelBox& part, std::span<std::byte> voxels, WorkPool& pool) const;
    void reverse(std::span<std::byte> voxels) const;

    const VolumeSource& source_;
    VoxelBox box_;
    bool reverses_;
    double ends_ = 0.0;  ///< sum of the smallest and the largest value of floats that are reversed
};

}  // namespace shvr
