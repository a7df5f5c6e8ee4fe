#pragma once
// Identifies the voxels of a volume independently of its file. Detects changes and mistakes, not forgery. There are two
// kinds of hashes, and which one a volume has depends on its voxels alone (kind_for):
//
// - "xxh3-128:" and 32 hexadecimal digits: XXH3-128 of every slice along z (voxels x fastest, then y, little-endian),
//   then XXH3-128 of those hashes in order, each in its canonical form.
// - "xxh3-128-chunks:" and 32 hexadecimal digits, which costs what is not uniform: XXH3-128 of the size (x, y, z as
//   int64), the number of the type and runs of equal chunks of 64^3 voxels, x fastest: their number, whether their
//   voxels differ (both uint64), and 16 bytes: the one voxel, and zeros; or XXH3-128 of those inside the volume.

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

enum class HashKind { slices, chunks };
/// By its prefix; null if it is no such hash.
std::optional<HashKind> kind_of(std::string_view hash);
/// Volumes of up to this many voxels are hashed in slices, as they are when they are measured.
inline constexpr int64_t MAX_VOXELS_IN_SLICES = MAX_VOXELS_EXACT;
/// The kind of a volume: chunks, if it is larger than that, and the voxels of at most an eighth of its chunks differ.
HashKind kind_for(const VolumeInfo& info, int64_t varied_chunks);

/// Collects what chunks contribute to a hash in chunks, in any order. Any thread may add.
class ChunkHasher {
public:
    explicit ChunkHasher(const VolumeInfo& info);

    /// `voxels`: the first of the chunk; rows and slices lie `row_bytes` and `slice_bytes` apart.
    void add(const Size3& chunk, const std::byte* voxels, size_t row_bytes, size_t slice_bytes);
    /// The number of chunks whose voxels differ.
    int64_t varied() const;
    /// `rest`: the voxel of which all chunks that were not added consist.
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

/// Hashes level 0 in slices. Where nothing is stored along whole slices, they cost one hash. Any thread may call it.
std::string content_hash(const VolumeSource& source);
/// The same in a given kind. Null if that would go through more than 2^38 bytes.
std::optional<std::string> content_hash(const VolumeSource& source, HashKind kind);
/// Whether two hashes name the same voxels; `known` is that of `source`. One of another kind is compared with the
/// source's in that kind, which reads it; null: no source, so that they count as different.
bool is_same_content(const std::string& stated, const std::string& known, const VolumeSource* source);

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
