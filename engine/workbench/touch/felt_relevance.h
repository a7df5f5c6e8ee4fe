#pragma once
// Passes relevance bits (which voxels can be felt) to the servo, or computes them from a volume. Any thread.

#include "engine/live/relevance_mirror.h"
#include "engine/session/session.h"
#include "haptics/relevance.h"

namespace shvr::ui {

/// Fills in `patch`, except its sequence number, time and settings.
void put_bits(const RelevancePlace& place, const RelevanceBits& bits, RelevancePatch& patch);
void put_mirrored(const MirroredRelevance& mirrored, RelevancePatch& patch);

/// Returns which voxels the hand may feel: those in the session's felt groups that the picture shows. If the session
/// lets the hand feel hidden voxels, voxels need not be shown.
FeltLimits felt_limits(const Session& session, const Camera& camera, const VolumeInfo& volume,
                       const IntensityWindow& window);

/// Computes the relevance around a probe, as the window's mirror does. `source` must include density offsets. `mask`
/// may be null if the limits do not depend on it or if nothing is painted.
void host_relevance(const VolumeSource& source, const Mask* mask, const FeltLimits& limits, const RegionWish& wish,
                    double threshold, RelevancePatch& patch);

}  // namespace shvr::ui
