#pragma once
// The cubes of 64^3 voxels, aligned with a box of a volume, in which something is stored. Cubes are independent of the
// size of the file's blocks. Any thread may call these functions.

#include <array>
#include <optional>
#include <vector>

#include "engine/volume/source.h"

namespace shvr {

/// Side of a cube in voxels: the size of the chunks of projects.
inline constexpr int64_t STORED_CHUNK = 64;

/// Returns the bits of x, y and z interleaved (Morton 1966). All chunks below one coarser chunk have adjacent keys.
uint64_t interleaved(const Size3& chunk);
Size3 uninterleaved(uint64_t key);

struct StoredChunks {
    Size3 counts{0};                  ///< number of chunks along each axis of the box
    std::vector<uint64_t> keys{};     ///< ascending, by `interleaved`
    std::array<std::byte, 8> fill{};  ///< the value of all voxels in other chunks
    int64_t blocks = 0;               ///< number of the file's blocks, from which the chunks were derived

    Size3 at(size_t index) const { return uninterleaved(keys[index]); }
    double all() const { return double(counts.x) * double(counts.y) * double(counts.z); }
};

/// Returns the keys, ascending, of the chunks of a box that contain stored blocks, in a volume of `size`. Null if there
/// are more than `most` chunks.
std::optional<std::vector<uint64_t>> chunk_keys(const StoredBlocks& stored, const Size3& size, const VoxelBox& box,
                                                int64_t most);
/// Returns null if the source does not know its stored blocks, or if all chunks, or more than `most`, are stored.
std::optional<StoredChunks> chunks_in(const VolumeSource& source, const VoxelBox& box, int64_t most);

}  // namespace shvr
