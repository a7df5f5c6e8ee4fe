#pragma once
// Data that an import collects about level 0 as it is read: the hash of every slice and, for types of 8 and 16 bits,
// how often each value occurs.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/projects/levels/import_state.h"
#include "engine/volume/content_hash.h"
#include "engine/volume/source.h"

namespace shvr {

/// Counts how often each value occurs, for types of 8 and 16 bits; does nothing for other types. Different workers may
/// add at the same time.
class ValueCounts {
public:
    ValueCounts(VoxelType type, int workers);
    void add(std::span<const std::byte> voxels, int worker);
    /// Adds `times` voxels with the value `voxel` in one step.
    void add(std::span<const std::byte> voxel, int64_t times, int worker);
    /// Returns null if the voxel type has too many values to count each of them.
    std::optional<VolumeStatistics> statistics() const;
    void save(StateWriter& state) const { state.put_all(total()); }
    void load(StateReader& state) { state.take_all(counts_[0]); }
    /// Adds the counts of another process.
    void merge(StateReader& state);

private:
    std::vector<int64_t> total() const;

    VoxelType type_;
    std::vector<std::vector<int64_t>> counts_;  ///< first index: worker; second: the bits of the value
};

class ImportTally {
public:
    /// `slices_at_once`: how many different slices may receive rows between two calls of `finish`.
    ImportTally(const VolumeInfo& info, int64_t slices_at_once, int workers);

    /// Adds the next rows of slice `slice`. Different workers may add to different slices at the same time.
    void add(int64_t slice, std::span<const std::byte> rows, int worker);
    /// Call once all rows of the slices from `lower` to `upper` have been added.
    void finish(int64_t lower, int64_t upper);

    /// Returns the hash of the whole volume, once all slices are finished.
    std::string content_hash() const;
    std::optional<VolumeStatistics> statistics() const { return counts_.statistics(); }

    /// Call this only when no slice is partly added.
    void save(StateWriter& state) const;
    void load(StateReader& state);
    /// Adds what another process collected about slices [lower, upper).
    void merge(StateReader& state, int64_t lower, int64_t upper);

private:
    SliceHasher& hasher_of(int64_t slice);

    std::vector<SliceHash> hashes_;     ///< by slice
    std::vector<SliceHasher> hashers_;  ///< hashers of unfinished slices, at index (slice number modulo size)
    ValueCounts counts_;
};

}  // namespace shvr
