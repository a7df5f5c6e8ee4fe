#pragma once
// A volume with density offsets: what another source reads, plus an offset for each voxel, clamped to what the voxel's
// type holds. Where there are no offsets it hands on the same bits.
//
// Coarser levels: the other source's value plus the offsets halved as levels are (halving.h). That is the mean of the
// sums but for one rounding and for voxels that were clamped.
//
// Threads. One thread sets offsets; any thread reads meanwhile. Bricks of offsets never change once they are there: a
// reader takes the ones it needs under a lock and adds them without it, so what one read returns is of one moment.

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

    /// The offsets of a brick of level 0 from now on; null: none. Those beyond the volume's end must be 0.
    struct Brick {
        glm::ivec3 brick{0};
        std::shared_ptr<const OffsetBrick> offsets;
    };
    /// Costs an eighth of a brick's work for each level above.
    void set(std::span<const Brick> bricks);
    /// No voxel has one.
    bool empty() const { return !any_.load(std::memory_order_acquire); }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    Size3 block() const override { return base_->block(); }
    int levels() const override { return base_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override;
    /// Those of the other source, widened by the offsets there and in the bricks around.
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override;
    /// Nothing is known of volumes with offsets.
    std::optional<VolumeStatistics> statistics() const override;

private:
    struct Entry {
        std::shared_ptr<const OffsetBrick> offsets;  ///< null: all of this level are 0
        ValueRange range;                            ///< of 0 and of all of level 0 that it stands for
    };
    using Entries = std::unordered_map<BrickKey, Entry, BrickKeyHash>;
    const Entry* find(const Entries& changed, const BrickKey& key) const;
    Entry parent(const Entries& changed, const BrickKey& key) const;

    std::shared_ptr<const VolumeSource> base_;
    mutable std::shared_mutex mutex_;
    Entries entries_;  ///< written by the thread that sets, under the lock
    std::atomic<bool> any_{false};
};

}  // namespace shvr
