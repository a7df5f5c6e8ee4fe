#pragma once
// Finds the parts of a Zarr image that are not stored, so that sparse volumes of other programs are skipped unread.
//
// Other programs need not store the mean of the finer level in a coarse one, so a part of a coarse level is a gap only
// if all parts of the finer levels that it covers, down to level 0, are gaps.
//
// The first query lists the chunks of a level (ZarrChunks::list) and keeps the list at 8 bytes per chunk. If a query
// needs only a few chunks, they are probed one by one instead, which is faster. So no level of a dense image is listed,
// since probes on a coarse level already answer the query. Levels with more than MAX_LISTED chunks are listed only on
// request; without the list, queries that need more than MAX_FILES probes return "unknown". So do queries on remote
// images, which cannot be listed, and where each probe would be a network request. Any thread may call these.

#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "engine/formats/zarr/zarr_volume.h"

namespace shvr {

class ZarrGaps {
public:
    static constexpr int64_t MAX_FILES = 512;
    static constexpr int64_t MAX_LISTED = int64_t{1} << 20;

    /// `levels` are all levels of one image, finest first; they must outlive this object.
    explicit ZarrGaps(const std::vector<ZarrVolume>& levels);
    ~ZarrGaps();

    /// Returns the range of the fill values if no chunk is stored for `box`, a part of `level`, nor for the same space
    /// in finer levels; lower > upper if no fill value is finite. Null if a chunk is stored, or the lookup is not
    /// possible.
    std::optional<ValueRange> range(int level, const VoxelBox& box) const;
    /// Returns the stored chunks of a level, sorted by z, then y, then x; null if there are more than `most`. Fails if
    /// listing fails.
    std::optional<std::vector<glm::ivec3>> stored(int level, int64_t most) const;

private:
    struct Level;
    /// A range of chunks: from `begin` up to, but not including, `end`.
    struct Chunks {
        Size3 begin{0}, end{0};
    };
    Chunks chunks_below(int level, const VoxelBox& box, int below) const;
    /// Null if it is unknown.
    std::optional<bool> are_missing(int level, const Chunks& chunks) const;

    const std::vector<ZarrVolume>& volumes_;
    std::vector<std::unique_ptr<Level>> levels_;
};

}  // namespace shvr
