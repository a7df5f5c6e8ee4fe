#pragma once
// A source of which some boxes can be held in memory, so that a thread that must not wait for a network can read them.
// Held boxes are read in the background, several at once. All other boxes are read from the base source.

#include <array>
#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "engine/volume/source.h"

namespace shvr {

class HeldSource final : public VolumeSource {
public:
    explicit HeldSource(std::shared_ptr<const VolumeSource> base);
    /// Ends the reads, also while they wait for a network.
    ~HeldSource() override;
    HeldSource(const HeldSource&) = delete;

    struct Part {
        int level = 0;
        VoxelBox box;
    };
    /// Holds these parts and no others. Returns whether all of them have been read. If not, reads them in the
    /// background; the caller has to ask again later. A part that cannot be read counts as read: reading its box fails.
    bool hold(std::span<const Part> parts);
    /// Holds no parts, and ends the reads.
    void release() { static_cast<void>(hold({})); }

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    Size3 block() const override { return base_->block(); }
    int levels() const override { return base_->levels(); }
    /// Never waits if the box is that of a held part which has been read.
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override;
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        return base_->brick_range(level, brick);
    }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        return base_->stored_blocks(level, most);
    }
    std::optional<VolumeStatistics> statistics() const override { return base_->statistics(); }

private:
    struct Held {
        std::vector<std::byte> voxels{};
        std::string failure{};
        bool is_begun = false, is_read = false;
    };
    using Key = std::array<int64_t, 7>;  ///< level, and the corners of the box
    static Key key_of(int level, const VoxelBox& box);
    void work(const std::stop_token& stop);
    Held read_part(const Key& key, const std::stop_token& stop) const;

    std::shared_ptr<const VolumeSource> base_;
    mutable std::mutex mutex_;
    std::condition_variable_any asked_;
    std::map<Key, Held> held_;
    std::atomic<bool> holds_any_ = false;  ///< avoids locking the mutex for each box
    std::vector<std::jthread> threads_;    ///< declared last, since they use the other members; started by `hold`
};

}  // namespace shvr
