#pragma once
// Handles volumes with unreadable parts, such as a truncated chunk. Work on such a volume either ends with a message,
// or continues without these parts (gaps), which it counts and reports.

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <unordered_map>

#include "engine/volume/source.h"

namespace shvr {

/// The unreadable parts of one volume. Each block counts once, however often a read of it fails. Any thread.
class Gaps {
public:
    /// `refused_with`: if not empty, a gap ends the work with an error, to which this advice for the user is added.
    explicit Gaps(std::string refused_with = {}) : refused_with_(std::move(refused_with)) {}

    /// Throws an `Error` with the reason if gaps end the work.
    void expect_none(const std::string& reason) const;
    /// Counts a whole block as missing, even if the error concerned only part of it.
    void add(const VoxelBox& block, const std::string& reason);
    bool empty() const { return voxels() == 0; }
    /// Returns whether `expect_none` has already thrown.
    bool has_refused() const { return has_refused_; }
    int64_t voxels() const;
    /// Returns a message with the number of missing voxels and the first reason; empty if no voxel is missing.
    std::string in_words() const;

private:
    std::string refused_with_;
    mutable std::atomic<bool> has_refused_ = false;
    mutable std::mutex mutex_;
    std::unordered_map<int64_t, int64_t> voxels_;  ///< number of missing voxels of a block, by its first voxel
    int64_t sum_ = 0;
    std::string first_reason_;
};

/// read_parts() reads a box of level 0 into `voxels`, and calls `take` with every readable part: the whole box if
/// possible, otherwise blocks of the file (slices if it has no blocks). Adds unreadable parts to `gaps`; without
/// `gaps`, throws the first error. `Stopped` always propagates.
using TakePart = std::function<void(const VoxelBox& part, std::span<const std::byte> voxels)>;
void read_parts(const VolumeSource& source, const VoxelBox& box, std::span<std::byte> voxels, Gaps* gaps,
                const TakePart& take);

/// A volume whose unreadable voxels have the lowest value of its type, or NaN. Both arguments must outlive this object.
/// If there are several levels, reads of single bricks fail instead, since their callers know better how to show a
/// missing brick.
class GapSource final : public VolumeSource {
public:
    GapSource(const VolumeSource& source, Gaps& gaps) : VolumeSource(source.info()), source_(source), gaps_(gaps) {}

    void read(const VoxelBox& box, std::span<std::byte> voxels) const override;
    Size3 block() const override { return source_.block(); }
    int levels() const override { return source_.levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (source_.levels() == 1)
            read(box, voxels);
        else
            source_.read_level(level, box, voxels);
    }
    std::optional<VolumeStatistics> statistics() const override { return source_.statistics(); }
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        return source_.brick_range(level, brick);
    }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        return source_.stored_blocks(level, most);
    }

private:
    void fill_with_lowest(std::span<std::byte> voxels) const;

    const VolumeSource& source_;
    Gaps& gaps_;
};

}  // namespace shvr
