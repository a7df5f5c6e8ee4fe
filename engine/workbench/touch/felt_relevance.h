#pragma once
// Passes relevance bits to the servo, and computes them from a volume if no mirror does. Any thread.

#include "engine/live/relevance_mirror.h"
#include "engine/session/session.h"
#include "haptics/relevance.h"

namespace shvr::ui {

/// Writes all of `patch` except sequence, time and settings.
void put_bits(const RelevancePlace& place, const RelevanceBits& bits, RelevancePatch& patch);
void put_mirrored(const MirroredRelevance& mirrored, RelevancePatch& patch);

/// Returns which voxels the session lets a hand feel: voxels in its felt groups, except those that the session's
/// picture does not show, unless hidden voxels are felt too.
FeltLimits felt_limits(const Session& session, const Camera& camera, const VolumeInfo& volume,
                       const IntensityWindow& window);

/// Computes the relevance around a probe as the window's mirror does. `source` includes density offsets already; `mask`
/// may be null if the limits do not need it, or if nothing is painted.
void host_relevance(const VolumeSource& source, const Mask* mask, const FeltLimits& limits, const RegionWish& wish,
                    double threshold, RelevancePatch& patch);

}  // namespace shvr::ui
