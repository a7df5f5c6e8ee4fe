#pragma once
// What an import learns of the voxels of level 0 while they go by: the hash of every slice, and how often each value
// occurs, for types of 8 and 16 bits.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/projects/import_state.h"
#include "engine/volume/content_hash.h"
#include "engine/volume/source.h"

namespace shvr {

class ImportTally {
public:
    /// Rows may come of `slices_at_once` slices between two calls of `finish`.
    ImportTally(const VolumeInfo& info, int64_t slices_at_once, int workers);

    /// The next rows of slice `slice`. Rows of different slices may be added at once, by different workers.
    void add(int64_t slice, std::span<const std::byte> rows, int worker);
    /// All rows of the slices from `lower` to `upper` were added.
    void finish(int64_t lower, int64_t upper);

    /// Of the whole volume, once all slices are finished.
    std::string content_hash() const;
    /// Nothing where there are too many values to count each.
    std::optional<VolumeStatistics> statistics() const;

    /// Where no slice is begun and not finished.
    void save(StateWriter& state) const;
    void load(StateReader& state);

private:
    std::vector<int64_t> total_counts() const;
    SliceHasher& hasher_of(int64_t slice);

    VoxelType type_;
    std::vector<SliceHash> hashes_;     ///< by slice
    std::vector<SliceHasher> hashers_;  ///< of slices that are begun, by the remainder of their number
    std::vector<std::vector<int64_t>>
        counts_;  ///< by worker, then by the value's bits; no values where there are too many
};

}  // namespace shvr
