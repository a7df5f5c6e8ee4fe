#pragma once
// Coarser levels, kept in memory, for a volume whose file has none: they take a seventh of the volume's own bytes.
// Level 0 is still read from the file.

#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// The levels' share of the host budget; the rest is for bricks and transfers.
inline constexpr uint64_t LEVELS_SHARE_OF_HOST = 4;

/// Returns the source itself if it has levels or is no larger than a brick. Reads the volume once. Fails before reading
/// if the levels, plus two slices while they are made, need more than a quarter of `host_budget_bytes`.
std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source, uint64_t host_budget_bytes);

}  // namespace shvr
