#pragma once
// Identifies the voxels of a volume independently of its file: XXH3-128 of every slice along z (voxels x fastest, then
// y, little-endian), then XXH3-128 of those hashes in order, each in its canonical form. Detects changes and mistakes,
// not forgery. Written as "xxh3-128:" and 32 hexadecimal digits.

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/volume/source.h"

namespace shvr {

using SliceHash = std::array<std::byte, 16>;

/// The hash of one slice whose rows arrive in order, in pieces. One thread at a time.
class SliceHasher {
public:
    SliceHasher();
    ~SliceHasher();
    SliceHasher(SliceHasher&&) noexcept;

    void add(std::span<const std::byte> voxels);
    /// The hash of the rows added so far; the next slice can then begin.
    SliceHash finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

std::string content_hash(std::span<const SliceHash> slices);

/// Hashes all of level 0, slice by slice. Any thread may call it.
std::string content_hash(const VolumeSource& source);

/// Forwards to another source, which must outlive it, and hashes the voxels that `read` returns of level 0. Callers
/// must read whole rows, each once and in order, one or more slices a call. `content_hash` does so, and so does
/// `measure` when it reads the whole volume. One thread at a time.
class HashedSource final : public VolumeSource {
public:
    explicit HashedSource(const VolumeSource& source);
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override;
    Size3 block() const override { return source_.block(); }
    int levels() const override { return source_.levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        source_.read_level(level, box, voxels);
    }
    std::optional<StoredBlocks> stored_blocks(int level, int64_t most) const override
    {
        return source_.stored_blocks(level, most);
    }
    std::optional<VolumeStatistics> statistics() const override { return source_.statistics(); }
    /// Empty unless all slices have been read. Later reads are not hashed.
    std::string hash() const;

private:
    const VolumeSource& source_;
    mutable std::vector<SliceHasher> hashers_;  ///< one per slice being read
    mutable std::vector<SliceHash> slices_;     ///< hashes of the completed slices
    mutable int64_t rows_ = 0;                  ///< rows read of the current slices
    mutable bool is_out_of_order_ = false;      ///< the reads are not hashed any further
};

}  // namespace shvr
