#pragma once
// The stored chunks of a Zarr array: each is a file (or an entry of an archive), or a part of a shard. Any thread may
// call these.
//
// The index of a shard is read once and kept, up to 16 MiB of indices; its checksums must match. The contents of an
// index are untrusted: a chunk must lie inside its shard and outside the index, and must not share bytes with another
// chunk, except for chunks with identical byte ranges.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/formats/zarr/metadata/zarr_metadata.h"
#include "engine/formats/zarr/store/chunk_cache.h"

namespace shvr {

class ZarrChunks {
public:
    ZarrChunks(ZarrPlace array, ZarrMetadata metadata);

    const ZarrMetadata& metadata() const { return metadata_; }
    /// Returns the file of a chunk or of its shard. A chunk is given by its index along each axis of the array.
    std::filesystem::path path_of(std::span<const int64_t> chunk) const;
    /// Returns a chunk's name for messages: its file or, in a shard, the shard's file and the chunk's indices.
    std::string name_of(std::span<const int64_t> chunk) const;

    /// Returns the stored bytes; null if the chunk is missing. Fails if reading fails, or if there are more bytes than
    /// a chunk can take.
    std::optional<std::vector<std::byte>> read(std::span<const int64_t> chunk) const;
    /// Reads chunks of a remote array ahead, in parallel, for later calls of `read`, which also report the failures.
    void prepare(std::span<const std::vector<int64_t>> chunks) const;
    bool is_remote() const { return array_.store->is_remote(); }
    /// True if the chunk is certainly not stored; false if it is stored, or if that cannot be determined.
    bool is_missing(std::span<const int64_t> chunk) const;
    /// Calls `take` with the indices of every stored chunk that matches `at` (null: any index), in no particular order.
    /// Stops and returns false if there are more than `most` matches, or if many other names make listing far slower
    /// than for `most` chunks. Reads only names and the indices of shards, and never probes for missing chunks. Fails
    /// if they cannot be read.
    bool list(std::span<const std::optional<int64_t>> at, int64_t most,
              const std::function<void(std::span<const int64_t> chunk)>& take) const;
    /// Searches a few values for a name that looks like a chunk's but is not: its indices lie beyond the array, or
    /// their number or spelling is wrong. Returns the first such value's path; empty if there is none.
    std::string stray() const;
    /// Decodes a stored chunk to voxels in native byte order, with its axes in the order `metadata().order`.
    Block decoded(std::span<const std::byte> stored, const std::string& name) const;

    /// These return the file that holds the metadata, and whether that file still exists.
    std::filesystem::path metadata_path() const { return array_.path_of(metadata_.key()); }
    bool is_there() const { return array_.has(metadata_.key()); }

private:
    /// The position of a chunk in its shard. Both numbers are ABSENT for a chunk that is not stored.
    struct Part {
        uint64_t offset, bytes;
    };
    static constexpr uint64_t ABSENT = ~uint64_t{0};
    static constexpr uint64_t SHARED = ABSENT - 1;  ///< offset of an entry of 0 bytes: the chunk shares its bytes with
                                                    ///< another

    std::string key_of(std::span<const int64_t> chunk) const;
    template <class Take>
    bool list_shard(std::span<const int64_t> shard, const Take& take) const;
    Part part_of(std::span<const int64_t> chunk, const std::string& shard) const;
    Block index_of(const std::string& shard) const;
    uint64_t shard_number(std::span<const int64_t> chunk) const;
    void prepare_indices(std::span<const std::vector<int64_t>> chunks) const;

    ZarrPlace array_;
    ZarrMetadata metadata_;
    mutable ChunkCache indices_;
};

/// Returns the indices of the chunk or shard with this `key`; empty if the array has no such chunk or shard.
std::vector<int64_t> chunk_numbers(const ZarrMetadata& metadata, std::string_view key);

}  // namespace shvr
