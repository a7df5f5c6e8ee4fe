#pragma once
// Coarser levels, kept in memory, for a volume whose file has none, or none that is coarse enough to begin with: they
// take a seventh of the bytes of its coarsest level, or of what that stores (sparse_levels.h). The levels of the file
// are still read from it.

#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// The levels' share of the host budget; the rest is for bricks and transfers.
inline constexpr uint64_t LEVELS_SHARE_OF_HOST = 4;

/// Returns the source itself if it has coarse levels or is no larger than a brick. Reads the volume once. Fails before
/// reading if the levels, plus two slices while they are made, need more than a quarter of `host_budget_bytes`.
std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source, uint64_t host_budget_bytes,
                                                const Progress& progress = {});
/// How many levels with_levels() would give it. Fails where that would, from sizes alone.
int planned_levels(const VolumeSource& source, uint64_t host_budget_bytes);

/// Host memory of what with_levels() would make; 0 where that is nothing.
uint64_t bytes_of_levels(const VolumeSource& source);

}  // namespace shvr
