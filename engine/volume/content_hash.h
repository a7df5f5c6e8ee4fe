#pragma once
// Identifies the voxels of a volume independently of its file. Detects changes and mistakes, not forgery. There are two
// kinds of hashes; the voxels alone determine the kind that a volume has (kind_for):
//
// - "xxh3-128:" and 32 hexadecimal digits: XXH3-128 of every slice along z (voxels x fastest, then y, little-endian),
//   then XXH3-128 of those hashes in order, each in its canonical form.
// - "xxh3-128-chunks:" and 32 hexadecimal digits, cheap where chunks are uniform: XXH3-128 of the size (x, y, z as
//   int64), the number of the type, and runs of equal chunks of 64^3 voxels, x fastest. A run: its length, whether its
//   voxels differ (both uint64), and 16 bytes: the single value and zeros, or XXH3-128 of the voxels inside the volume.

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/volume/source.h"

namespace shvr {

using SliceHash = std::array<std::byte, 16>;

/// Computes the hash of one slice at a time. Rows must arrive in order, and may arrive in pieces. One thread at a time.
class SliceHasher {
public:
    SliceHasher();
    ~SliceHasher();
    SliceHasher(SliceHasher&&) noexcept;

    void add(std::span<const std::byte> voxels);
    /// Returns the hash of the rows added so far, and starts the next slice.
    SliceHash finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

std::string content_hash(std::span<const SliceHash> slices);

enum class HashKind { slices, chunks };
/// Returns the kind that the hash's prefix states; null if the text is no such hash.
std::optional<HashKind> kind_of(std::string_view hash);
/// Volumes of up to this many voxels always have a hash in slices, which is computed while they are measured.
inline constexpr int64_t MAX_VOXELS_IN_SLICES = MAX_VOXELS_EXACT;
/// Returns the kind for a volume: chunks if it is larger than that and at most an eighth of its chunks is not uniform.
HashKind kind_for(const VolumeInfo& info, int64_t varied_chunks);

/// Collects the digests of single chunks for a HashKind::chunks hash, in any order. Any thread may add.
class ChunkHasher {
public:
    explicit ChunkHasher(const VolumeInfo& info);

    /// `voxels`: the first voxel of the chunk. Rows lie `row_bytes` apart, and slices `slice_bytes` apart.
    void add(const Size3& chunk, const std::byte* voxels, size_t row_bytes, size_t slice_bytes);
    /// Returns the number of chunks whose voxels are not all equal.
    int64_t varied() const;
    /// `rest`: the value of all voxels in chunks that were not added.
    std::string hash(std::span<const std::byte> rest) const;

    struct Digest {
        uint64_t chunk, is_varied;
        SliceHash bytes;
    };
    const std::vector<Digest>& digests() const { return digests_; }
    void restore(std::vector<Digest> digests) { digests_ = std::move(digests); }

private:
    Size3 size_, counts_;
    VoxelType type_;
    std::mutex mutex_;
    std::vector<Digest> digests_;
};

/// Hashes level 0 in slices. All slices in which nothing is stored are equal, and are hashed only once. Any thread.
std::string content_hash(const VolumeSource& source);
/// Computes the hash of the given kind. Returns null if more than 2^38 bytes would have to be read.
std::optional<std::string> content_hash(const VolumeSource& source, HashKind kind);
/// Whether two hashes are of the same voxels; `known` is the hash of `source`. If `stated` is of the other kind, reads
/// the source to compute a hash of that kind, or returns false if `source` is null.
bool is_same_content(const std::string& stated, const std::string& known, const VolumeSource* source);

/// Forwards to another source, which must outlive this object, and hashes the voxels of level 0 that pass through
/// `read`. Callers must read whole rows, each once and in order, one or more slices per call, as `content_hash` does,
/// and as `measure` does if it reads the whole volume. One thread at a time.
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
    /// Returns the hash; empty unless all slices have been read. Reads after that are not hashed.
    std::string hash() const;

private:
    const VolumeSource& source_;
    mutable std::vector<SliceHasher> hashers_;  ///< one per slice being read
    mutable std::vector<SliceHash> slices_;     ///< hashes of the completed slices
    mutable int64_t rows_ = 0;                  ///< rows read of the current slices
    mutable bool is_out_of_order_ = false;      ///< if true, later reads are not hashed
};

}  // namespace shvr
