#pragma once
// A volume inside a Zarr array of version 2: three of its axes, at fixed places along the others, chunk by chunk.
//
// A chunk that is not there holds the fill value; one that cannot be read or decoded is an `Error` with its path.
// Chunks at the end of an axis are as large as all others, and what lies beyond the array is never looked at. Any
// thread may call it.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/formats/zarr/chunk_cache.h"
#include "engine/formats/zarr/zarr_metadata.h"
#include "engine/volume/grid.h"

namespace shvr {

/// Which of an array's axes a volume's are, and where it lies along the others.
struct ZarrView {
    std::array<size_t, 3> xyz{2, 1, 0};  ///< the array's axis along x, y and z
    std::vector<int64_t> at{};           ///< an index for every axis of the array; those along x, y and z are ignored
};

/// What a chunk's stored bytes must be, so that damage is found even where it can be decoded. 0: no chunk is stored.
uint64_t checksum_of(std::span<const std::byte> stored);

class ZarrVolume {
public:
    ZarrVolume(std::filesystem::path array, ZarrMetadata metadata, ZarrView view);

    const ZarrMetadata& metadata() const { return metadata_; }
    const Size3& size() const { return size_; }      ///< voxels
    const Size3& chunk() const { return chunk_; }    ///< voxels of a chunk
    const Size3& counts() const { return counts_; }  ///< chunks
    int64_t index_of(const Size3& chunk) const { return shvr::index_of(chunk, counts_); }
    std::filesystem::path path_of(const Size3& chunk) const;

    /// From now on stored chunks are compared with these, by `index_of`. Not while others read.
    void expect(std::vector<uint64_t> checksums) { checksums_ = std::move(checksums); }

    /// The voxels of a chunk, x fastest, in native byte order; empty where they are all the fill value.
    Block load(const Size3& chunk) const;

    /// True where no such chunk is stored, nor should be: it holds the fill value. Nothing is read.
    bool is_missing(const Size3& chunk) const;
    /// The array is still where it was opened.
    bool is_there() const;

    /// Copies the voxels of `box`, which lies inside the volume, x fastest. `get` gives the chunks.
    void read(const VoxelBox& box, std::span<std::byte> voxels,
              const std::function<std::shared_ptr<const Block>(const Size3& chunk)>& get) const;

private:
    Block decoded(std::span<const std::byte> stored, const std::string& name) const;
    Block arranged(Block chunk) const;

    std::filesystem::path array_;
    ZarrMetadata metadata_;
    ZarrView view_;
    Size3 size_{0}, chunk_{0}, counts_{0};
    std::vector<uint64_t> checksums_;
};

}  // namespace shvr
