#pragma once
// Keeps coarser levels in memory for a volume whose file has none, or none coarse enough to start with: they take a
// seventh of the bytes of its coarsest level, or of the stored part of that (sparse_levels.h). The file's own levels
// are still read from it.

#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// Share of the host budget for the levels, as a divisor; the rest is for bricks and transfers.
inline constexpr uint64_t LEVELS_SHARE_OF_HOST = 4;

/// Returns the source itself if it has coarse levels or is no larger than a brick. Reads the volume once. Fails before
/// reading if the levels, plus two slices while they are made, need more than a quarter of `host_budget_bytes`.
std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source, uint64_t host_budget_bytes,
                                                const Progress& progress = {});
/// Number of levels that with_levels() would provide. Fails if with_levels() would fail, judging from sizes alone.
int planned_levels(const VolumeSource& source, uint64_t host_budget_bytes);

/// Host memory of the levels that with_levels() would make; 0 if there are none.
uint64_t bytes_of_levels(const VolumeSource& source);

}  // namespace shvr
