#pragma once
// Finds where a Zarr image stores nothing, so that sparse volumes from other programs are skipped without being read.
//
// In such files levels need not be means of each other, so a part of a coarse level is a gap only if everything below
// it, down to level 0, is one. That multiplies the chunks by eight per level: a query that would check more than
// MAX_FILES files is not answered. With chunks of 64^3 voxels that affects bricks of level 4 and above; with chunks of
// 32^3, of level 3 and above.
//
// Each file is looked up once, which takes some microseconds, and the result is kept in one byte per chunk. Any thread
// may call it.

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "engine/formats/zarr/zarr_volume.h"

namespace shvr {

class ZarrGaps {
public:
    static constexpr int64_t MAX_FILES = 512;

    /// `levels` are those of one image, finest first, and must outlive it.
    explicit ZarrGaps(const std::vector<ZarrVolume>& levels);

    /// The range of the values of `box`, a part of `level`, and of everything below it in finer levels, if none of
    /// their chunks is stored: the range of the fill values, lower > upper if none is finite. Nothing if a chunk is
    /// stored, or cannot be looked up.
    std::optional<ValueRange> range(int level, const VoxelBox& box) const;

private:
    /// A range of chunks, from and to.
    struct Chunks {
        Size3 begin{0}, end{0};
        int64_t count() const { return (end.x - begin.x) * (end.y - begin.y) * (end.z - begin.z); }
    };
    Chunks chunks_below(int level, const VoxelBox& box, int below) const;
    bool are_missing(int level, const Chunks& chunks) const;
    bool is_missing(int level, const Size3& chunk) const;

    enum class Found : uint8_t { unknown, stored, missing };
    const std::vector<ZarrVolume>& levels_;
    std::vector<std::unique_ptr<std::atomic<Found>[]>> found_;  ///< by level; null if there are too many chunks
};

}  // namespace shvr
