#pragma once
// The stored chunks of a Zarr array, each a file (or an entry of an archive), or a part of a shard. Any thread may call
// it.
//
// The index of a shard is read once and kept, up to 16 MiB of indices; its checksums must hold. What an index says is
// untrusted: a chunk must lie inside its shard and outside the index, and must not share bytes with another chunk, with
// the exception of chunks that are the same bytes altogether.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/formats/zarr/chunk_cache.h"
#include "engine/formats/zarr/zarr_metadata.h"

namespace shvr {

class ZarrChunks {
public:
    ZarrChunks(ZarrPlace array, ZarrMetadata metadata);

    const ZarrMetadata& metadata() const { return metadata_; }
    /// The file of a chunk, or of its shard. Chunks are given by their number along each axis of the array.
    std::filesystem::path path_of(std::span<const int64_t> chunk) const;
    /// The chunk's file or, in a shard, that and its numbers.
    std::string name_of(std::span<const int64_t> chunk) const;

    /// The bytes as they are stored; nothing if none are. Fails if they cannot be read, or are more than a chunk needs.
    std::optional<std::vector<std::byte>> read(std::span<const int64_t> chunk) const;
    /// True if the chunk is not stored. False where that cannot be determined.
    bool is_missing(std::span<const int64_t> chunk) const;
    /// Calls `take` with the numbers of every stored chunk that has those of `at` (nothing: any), in no order. False,
    /// and stops, as soon as there are more than `most`, or so many other names that going on would take much longer
    /// than `most` chunks should. Reads names and the indices of shards, and never looks for what is missing. Fails if
    /// those cannot be read.
    bool list(std::span<const std::optional<int64_t>> at, int64_t most,
              const std::function<void(std::span<const int64_t> chunk)>& take) const;
    /// The path of a value among the first few that is named like a chunk and is none of the array's: its numbers lie
    /// beyond the array, or are not as many, or are spelled in another way. Empty if none is seen.
    std::string stray() const;
    /// The voxels of a stored chunk, native byte order, axes in `metadata().order`.
    Block decoded(std::span<const std::byte> stored, const std::string& name) const;

    /// The file of the metadata, and whether it still is where it was.
    std::filesystem::path metadata_path() const { return array_.path_of(metadata_.key()); }
    bool is_there() const { return array_.has(metadata_.key()); }

private:
    /// Where a chunk lies in its shard; both are ABSENT for a chunk that is not stored.
    struct Part {
        uint64_t offset, bytes;
    };
    static constexpr uint64_t ABSENT = ~uint64_t{0};
    static constexpr uint64_t SHARED = ABSENT - 1;  ///< with 0 bytes: the chunk shares bytes with another

    std::string key_of(std::span<const int64_t> chunk) const;
    std::vector<int64_t> numbers_of(std::string_view key) const;
    template <class Take>
    bool list_shard(std::span<const int64_t> shard, const Take& take) const;
    Part part_of(std::span<const int64_t> chunk, const std::string& shard) const;
    Block index_of(const std::string& shard) const;

    ZarrPlace array_;
    ZarrMetadata metadata_;
    mutable ChunkCache indices_;
};

}  // namespace shvr
