#pragma once
// Walks over a volume: which voxels statistics are computed from (all, the stored voxels of a sparse volume, or a
// sample), and a source that reports how much has been read.

#include <algorithm>
#include <exception>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "engine/volume/source.h"

namespace shvr {

/// The boxes of level 0 to read, in this order.
class VoxelWalk {
public:
    /// All voxels, as whole rows in order. A box has at most 16 MiB, but at least one row of blocks.
    static VoxelWalk all(const VolumeSource& source);
    /// The voxels of stored blocks. All other voxels are counted by rest().
    static VoxelWalk stored(const VolumeSource& source, StoredBlocks blocks);
    /// A sample: evenly spread pieces, or as many voxels of stored blocks, with a proportional number in rest().
    static VoxelWalk sample(const VolumeSource& source);

    int64_t voxels() const { return voxels_; }  ///< total of all boxes
    int64_t boxes() const;
    VoxelBox box(int64_t index) const;
    /// Number of voxels that are counted without being read, since all have the value `fill`.
    int64_t rest() const { return rest_; }
    double fill() const { return fill_; }

private:
    Size3 size_{0};
    Size3 step_{0};                                 ///< size of a box if all voxels are read: x is a whole row
    std::optional<std::vector<VoxelBox>> boxes_{};  ///< null if all voxels are read
    int64_t voxels_ = 0, rest_ = 0;
    double fill_ = 0.0;
};

/// Calls `take` with each box of the walk in order and its voxels, while another thread reads the next box into a
/// second buffer. `failure`: why the box could not be read; null if it was. Only if not may `take` use the source: no
/// other thread does meanwhile. An exception from `take` ends the walk. Boxes above 16 MiB share one buffer.
using TakeBox =
    std::function<void(const VoxelBox& box, std::span<std::byte> voxels, const std::exception_ptr& failure)>;
void read_boxes(const VolumeSource& source, const VoxelWalk& walk, const TakeBox& take);

/// Returns the number of voxels in stored blocks, clipped to a volume of `size`.
int64_t voxels_stored(const StoredBlocks& stored, const Size3& size);
/// Returns the box of a block, clipped to a volume of `size`.
VoxelBox box_of_block(const StoredBlocks& stored, const glm::ivec3& block, const Size3& size);

/// Forwards to a source, and reports how much of level 0 has been read, for work that reads every voxel once. `source`
/// and `progress` must outlive this object. One thread at a time.
class ToldSource final : public VolumeSource {
public:
    ToldSource(const VolumeSource& source, const Progress& progress)
        : VolumeSource(source.info()), source_(source), progress_(progress), all_(double(voxel_count(source.info())))
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        source_.read(box, voxels);
        const Size3 extent = box.size();
        read_ += double(extent.x) * double(extent.y) * double(extent.z);
        tell(progress_, std::min(1.0, read_ / all_));
    }
    Size3 block() const override { return source_.block(); }
    /// Who asks for them reads nothing else.
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        std::optional<StoredBlocks> stored = source_.stored_blocks(level, most);
        if (stored && level == 0) {
            const Size3& block = stored->block;
            all_ = std::min(all_, double(block.x) * double(block.y) * double(block.z) * double(stored->blocks.size()));
        }
        return stored;
    }

private:
    const VolumeSource& source_;
    const Progress& progress_;
    mutable double all_;  ///< voxels to be read, about
    mutable double read_ = 0.0;
};

}  // namespace shvr
