#pragma once
// The cubes of 64^3 voxels, aligned with a box of a volume, in which something is stored, whatever blocks the file has.
// Any thread may call these.

#include <array>
#include <optional>
#include <vector>

#include "engine/volume/source.h"

namespace shvr {

/// Voxels along each axis of a cube: that of the chunks of projects.
inline constexpr int64_t STORED_CHUNK = 64;

/// The bits of x, y and z interleaved (Morton 1966): chunks below one of a coarser level are adjacent.
uint64_t interleaved(const Size3& chunk);
Size3 uninterleaved(uint64_t key);

struct StoredChunks {
    Size3 counts{0};                  ///< chunks along each axis of the box
    std::vector<uint64_t> keys{};     ///< ascending, by `interleaved`
    std::array<std::byte, 8> fill{};  ///< the voxel of which all other chunks consist
    int64_t blocks = 0;               ///< blocks of the file, from which they were found

    Size3 at(size_t index) const { return uninterleaved(keys[index]); }
    double all() const { return double(counts.x) * double(counts.y) * double(counts.z); }
};

/// The keys, ascending, of the chunks of a box of a volume of `size` in which there are stored blocks; null if there
/// are more than `most`.
std::optional<std::vector<uint64_t>> chunk_keys(const StoredBlocks& stored, const Size3& size, const VoxelBox& box,
                                                int64_t most);
/// Null if the source does not know what it stores, stores something in every chunk, or in more than `most`.
std::optional<StoredChunks> chunks_in(const VolumeSource& source, const VoxelBox& box, int64_t most);

}  // namespace shvr
