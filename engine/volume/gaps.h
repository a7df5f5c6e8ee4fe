#pragma once
// Work on a volume of which some cannot be read, as a chunk that is cut short: either it ends with a sentence, or it
// goes on without that, counts it, and says so.

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <unordered_map>

#include "engine/volume/source.h"

namespace shvr {

/// What could not be read of one volume. Each block counts once, however often it is tried. Any thread.
class Gaps {
public:
    /// `refused_with`: what a person can do about a gap, which then ends the work; empty: work goes on.
    explicit Gaps(std::string refused_with = {}) : refused_with_(std::move(refused_with)) {}

    /// Throws an `Error` with the reason, where gaps are refused.
    void expect_none(const std::string& reason) const;
    /// All of a block, by however little of it that was noticed.
    void add(const VoxelBox& block, const std::string& reason);
    bool empty() const { return voxels() == 0; }
    /// Whether `expect_none` has told, beside the reason, what a person can do.
    bool has_refused() const { return has_refused_; }
    int64_t voxels() const;
    /// How much is missing, and the first reason; empty if nothing is.
    std::string in_words() const;

private:
    std::string refused_with_;
    mutable std::atomic<bool> has_refused_ = false;
    mutable std::mutex mutex_;
    std::unordered_map<int64_t, int64_t> voxels_;  ///< of each block, by its first voxel
    int64_t sum_ = 0;
    std::string first_reason_;
};

/// Reads a box of level 0 into `voxels`, and hands out what could be read: all of it, or else blocks of the file, or
/// slices where it has none. The rest is added to `gaps`; without these the first failure is thrown. `Stopped` always
/// is.
using TakePart = std::function<void(const VoxelBox& part, std::span<const std::byte> voxels)>;
void read_parts(const VolumeSource& source, const VoxelBox& box, std::span<std::byte> voxels, Gaps* gaps,
                const TakePart& take);

/// A volume in which each voxel that cannot be read is as low as its type allows, or NaN. Both must outlive it. Where
/// there are several levels, who reads those brick by brick knows better what to show instead of one that fails: there
/// it fails.
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
