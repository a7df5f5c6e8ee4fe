#pragma once
// Finds where a Zarr image stores nothing, so that sparse volumes from other programs are skipped without being read.
//
// In such files levels need not be means of each other, so a part of a coarse level is a gap only if everything below
// it, down to level 0, is one.
//
// The chunks of a level are listed once, on the first query (ZarrChunks::list), and kept as 8 bytes each. A few chunks
// are probed one by one instead, as long as that is faster, so that in dense images, where a coarse level already gives
// the answer, no level is listed. Levels with more than MAX_LISTED chunks are listed only on request; there, a query
// that would need more than MAX_FILES probes is not answered. Any thread may call it.

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

    /// `levels` are those of one image, finest first, and must outlive it.
    explicit ZarrGaps(const std::vector<ZarrVolume>& levels);
    ~ZarrGaps();

    /// The range of the values of `box`, a part of `level`, and of everything below it in finer levels, if none of
    /// their chunks is stored: the range of the fill values, lower > upper if none is finite. Null if a chunk is
    /// stored, or cannot be looked up.
    std::optional<ValueRange> range(int level, const VoxelBox& box) const;
    /// The stored chunks of a level, sorted by z, then y, then x; null if there are more than `most`. Fails if they
    /// cannot be listed.
    std::optional<std::vector<glm::ivec3>> stored(int level, int64_t most) const;

private:
    struct Level;
    /// A range of chunks, from and to.
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
