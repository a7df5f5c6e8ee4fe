#pragma once
// Adds coarser levels, in memory, to a volume whose file has none, or none that is coarse enough to start with. The
// added levels take a seventh of the bytes of the file's coarsest level, or of the stored part of that level
// (sparse_levels.h). The file's own levels are still read from the file.

#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// Added levels may use 1 / LEVELS_SHARE_OF_HOST of the host budget. The rest is for bricks and transfers.
inline constexpr uint64_t LEVELS_SHARE_OF_HOST = 4;

/// Returns the source itself if it has coarse levels or is no larger than a brick. Otherwise reads the volume once.
/// Fails before that if the levels, and the two slices needed to make them, exceed a quarter of `host_budget_bytes`.
std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source, uint64_t host_budget_bytes,
                                                const Progress& progress = {});
/// Returns the number of levels that with_levels() would provide, from sizes alone. Fails if with_levels() would fail.
int planned_levels(const VolumeSource& source, uint64_t host_budget_bytes);

/// Returns the host memory of the levels that with_levels() would add; 0 if it would add none.
uint64_t bytes_of_levels(const VolumeSource& source);

}  // namespace shvr
