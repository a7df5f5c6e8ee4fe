#pragma once
// A volume inside a Zarr array: three of the array's axes, at a fixed index along the others. Reads whole chunks.
//
// A missing chunk holds the fill value; a chunk that cannot be read or decoded causes an `Error` with its path. Chunks
// at the end of an axis have the full size, and their part outside the array is ignored. Any thread may call these.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/formats/zarr/store/chunk_cache.h"
#include "engine/formats/zarr/zarr_chunks.h"
#include "engine/volume/grid.h"

namespace shvr {

/// Selects a volume in an array: three of the array's axes, and a fixed index along each of the others.
struct ZarrView {
    std::array<size_t, 3> xyz{2, 1, 0};  ///< indices of the array's axes for x, y and z
    std::vector<int64_t> at{};           ///< index along each axis of the array; not used for those in `xyz`
};

/// Returns the checksum of a chunk's stored bytes, to detect damage even if they still decode. 0 means not stored.
uint64_t checksum_of(std::span<const std::byte> stored);

/// A chunk that an import wrote: its number (ZarrVolume::index_of), and the checksum of its stored bytes.
struct StoredChunk {
    uint64_t index, checksum;
};

class ZarrVolume {
public:
    ZarrVolume(ZarrPlace array, ZarrMetadata metadata, ZarrView view);

    const ZarrMetadata& metadata() const { return chunks_->metadata(); }
    const Size3& size() const { return size_; }      ///< voxels
    const Size3& chunk() const { return chunk_; }    ///< voxels of a chunk along each axis
    const Size3& counts() const { return counts_; }  ///< chunks
    int64_t index_of(const Size3& chunk) const { return shvr::index_of(chunk, counts_); }
    /// Returns the file of a chunk, or of the shard that holds it.
    std::filesystem::path path_of(const Size3& chunk) const;

    /// Sets the list of all chunks that should be stored, in ascending order. Chunks are verified against it from then
    /// on. Must not be called while other threads read.
    void expect(std::vector<StoredChunk> chunks) { expected_ = std::move(chunks); }

    /// Returns the voxels of a chunk, x fastest, in native byte order; empty if all of them are the fill value.
    Block load(const Size3& chunk) const;

    /// Reads chunks of a remote array ahead, in parallel, for later calls of `load`.
    void prepare(std::span<const Size3> chunks) const;
    bool is_remote() const { return chunks_->is_remote(); }

    /// Whether the chunk is not stored, and should not be, so that all its voxels have the fill value. Reads at most
    /// the index of a shard.
    bool is_missing(const Size3& chunk) const;
    /// Calls `take` for each chunk that is stored, or should be, in no particular order. Stops and returns false if
    /// there are more than `most`. Reads only names and the indices of shards, and never probes for missing chunks.
    bool list_stored(int64_t most, const std::function<void(const Size3& chunk)>& take) const;
    /// As ZarrChunks::stray.
    std::string stray_chunk() const { return chunks_->stray(); }
    /// Returns the value of voxels in chunks that are not stored.
    double fill() const;
    /// Whether the array still exists where it was opened.
    bool is_there() const { return chunks_->is_there(); }

    /// Copies the voxels of `box`, which lies inside the volume, x fastest. `get` returns the chunks.
    void read(const VoxelBox& box, std::span<std::byte> voxels,
              const std::function<std::shared_ptr<const Block>(const Size3& chunk)>& get) const;

private:
    std::vector<int64_t> numbers_of(const Size3& chunk) const;
    Block arranged(Block chunk) const;
    /// Returns the checksum that a chunk must have; 0: it must not be stored. Call this only if checksums are known.
    uint64_t expected_checksum(const Size3& chunk) const;

    std::shared_ptr<const ZarrChunks> chunks_;
    ZarrView view_;
    Size3 size_{0}, chunk_{0}, counts_{0};
    std::optional<std::vector<StoredChunk>> expected_;
};

}  // namespace shvr
