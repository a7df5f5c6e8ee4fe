#pragma once
// A volume with density offsets: another source's values plus an offset per voxel, clamped to the range of the type.
// Voxels without an offset keep their bits.
//
// A voxel of a coarser level is the base source's value plus the halved offsets (halving.h). It equals the mean of the
// offset voxels below, except for one rounding, and except where voxels were clamped.
//
// Threads: one thread sets offsets while any thread reads. Bricks of offsets are immutable: a reader fetches the bricks
// it needs under a lock and adds them without the lock, so each read sees a consistent snapshot of the offsets.

#include <atomic>
#include <shared_mutex>
#include <unordered_map>

#include "engine/volume/brick_key.h"
#include "engine/volume/offset_brick.h"
#include "engine/volume/source.h"

namespace shvr {

class OffsetSource final : public VolumeSource {
public:
    explicit OffsetSource(std::shared_ptr<const VolumeSource> base);

    /// The new offsets of a brick of level 0; null removes them. Offsets outside the volume must be 0.
    struct Brick {
        glm::ivec3 brick{0};
        std::shared_ptr<const OffsetBrick> offsets;
    };
    /// Replaces the offsets of these bricks and updates coarser levels, each at an eighth of the cost of the finer one.
    void set(std::span<const Brick> bricks);
    /// Whether no voxel has an offset.
    bool empty() const { return !any_.load(std::memory_order_acquire); }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    Size3 block() const override { return base_->block(); }
    int levels() const override { return base_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override;
    /// Returns the base source's range, widened by the offsets of this brick and of neighbouring bricks.
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override;
    /// Returns the stored blocks of the base source, and all blocks that have an offset.
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override;
    /// Unknown for volumes with offsets.
    std::optional<VolumeStatistics> statistics() const override;

private:
    struct Entry {
        std::shared_ptr<const OffsetBrick> offsets;  ///< null: all offsets of this level are 0
        ValueRange range;                            ///< range of 0 and the level 0 offsets below this brick
    };
    using Entries = std::unordered_map<BrickKey, Entry, BrickKeyHash>;
    const Entry* find(const Entries& changed, const BrickKey& key) const;
    Entry parent(const Entries& changed, const BrickKey& key) const;

    std::shared_ptr<const VolumeSource> base_;
    mutable std::shared_mutex mutex_;
    Entries entries_;  ///< changed under the lock, only by the thread that sets offsets
    std::atomic<bool> any_{false};
};

}  // namespace shvr
