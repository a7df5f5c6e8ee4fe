#pragma once
// Files of one value per voxel, x fastest, without a header, read and written in strips: the rows of one slice that
// cross one row of bricks. A strip is contiguous in the file and holds at most 2^25 voxels.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "engine/base/file.h"
#include "engine/volume/grid.h"
#include "engine/volume/volume.h"
#include "shaders/bricks.h"

namespace shvr {

/// Advice for messages when a file with a value for each voxel does not fit on its disk (expect_space).
inline constexpr const char* MORE_SPACE = "free some of it, or choose .zarr, which holds what is painted alone";
/// Size in bytes of a file that holds all voxels; null if that exceeds 2^63 - 1.
std::optional<int64_t> bytes_of_voxels(const Size3& size, int64_t bytes_per_voxel);

struct VoxelStrip {
    Size3 size;  ///< size of the volume
    int64_t z, brick_y;
    int64_t height() const { return std::min<int64_t>(gpu::BRICK_SIZE, size.y - brick_y * gpu::BRICK_SIZE); }
    size_t voxels() const { return size_t(size.x * height()); }
    /// Whether this is the last strip of its slice.
    bool ends_slice() const { return (brick_y + 1) * gpu::BRICK_SIZE >= size.y; }
    /// Whether this is the last strip of its layer of bricks.
    bool ends_layer() const
    {
        const bool is_last_slice = z % gpu::BRICK_SIZE == gpu::BRICK_SIZE - 1 || z == size.z - 1;
        return is_last_slice && ends_slice();
    }
};

template <class Visit>
void for_each_strip(const Size3& size, const Visit& visit)
{
    for (int64_t z = 0; z < size.z; ++z)
        for (int64_t brick_y = 0; brick_y * gpu::BRICK_SIZE < size.y; ++brick_y) visit(VoxelStrip{size, z, brick_y});
}

/// Calls `visit(first voxel in the strip, first voxel in the brick, length)` for each row of the strip in a brick.
template <class Visit>
void for_each_row(const VoxelStrip& strip, int64_t brick_x, const Visit& visit)
{
    const int64_t width = std::min(BRICK_SIDE, strip.size.x - brick_x * BRICK_SIDE);
    for (int64_t y = 0; y < strip.height(); ++y)
        visit(size_t(brick_x * BRICK_SIDE + strip.size.x * y),
              size_t(BRICK_SIDE * (y + BRICK_SIDE * (strip.z % BRICK_SIDE))), size_t(width));
}

/// Opens a file that must hold exactly `bytes_per_voxel` for each voxel. `kind`: the expected suffix, for messages.
FileDescriptor open_voxels(const std::filesystem::path& path, const Size3& size, int64_t bytes_per_voxel,
                           const char* kind);
/// Fills `bytes`, starting where the last read ended.
void read_next(const FileDescriptor& file, const std::filesystem::path& path, std::span<std::byte> bytes);

}  // namespace shvr
