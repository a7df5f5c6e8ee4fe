#pragma once
// Coarser levels for a volume whose file has none, kept in memory: a seventh of the volume's own bytes. Level 0 is still read
// from the file.

#include <memory>

#include "engine/volume/source.h"

namespace shvr {

/// The source itself where it has levels, or is no larger than a brick. Goes through the volume once. Fails, before it reads,
/// where the levels take more than `most_bytes`.
std::shared_ptr<const VolumeSource> with_levels(std::shared_ptr<const VolumeSource> source, uint64_t most_bytes);

}  // namespace shvr
