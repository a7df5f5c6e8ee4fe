#pragma once
// Where nothing is stored of a Zarr image, so that sparse volumes that others wrote are skipped without being read.
//
// Levels of others need not be means of each other, so a part of a coarse level is a gap only where all that it stands
// for, down to level 0, is one. That is eight times as many chunks a level: a question that would take more than
// MOST_FILES is not answered. In chunks of 64^3 voxels that is so for bricks of level 4 and above; in chunks of 32^3,
// of level 3 and above.
//
// A file is looked for once, for some microseconds, and what was found is kept in a byte a chunk. Any thread may call
// it.

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "engine/formats/zarr/zarr_volume.h"

namespace shvr {

class ZarrGaps {
public:
    static constexpr int64_t MOST_FILES = 512;

    /// `levels` are those of one image, the finest first, and must outlive it.
    explicit ZarrGaps(const std::vector<ZarrVolume>& levels);

    /// The range of the values of `box`, a part of `level`, and of all it stands for in finer levels, where none of
    /// their chunks is stored: of the fill values, lower > upper where none is finite. Nothing where one is stored, or
    /// cannot be looked for.
    std::optional<ValueRange> range(int level, const VoxelBox& box) const;

private:
    /// Chunks, from and to.
    struct Chunks {
        Size3 begin{0}, end{0};
        int64_t count() const { return (end.x - begin.x) * (end.y - begin.y) * (end.z - begin.z); }
    };
    Chunks chunks_below(int level, const VoxelBox& box, int below) const;
    bool are_missing(int level, const Chunks& chunks) const;
    bool is_missing(int level, const Size3& chunk) const;

    enum class Found : uint8_t { unknown, stored, missing };
    const std::vector<ZarrVolume>& levels_;
    std::vector<std::unique_ptr<std::atomic<Found>[]>> found_;  ///< by level; null where there are too many chunks
};

}  // namespace shvr
